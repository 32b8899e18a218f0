/* What a Cortex-M7 needs before main, and semihosting in place of an operating system: text out, and an exit code.
 * Sources: Armv7-M Architecture Reference Manual (DDI 0403E), B1.5.3 vector table, B3.2.20 CPACR; Arm semihosting
 * (ARM IHI 0111), SYS_WRITE0 0x04, SYS_EXIT_EXTENDED 0x20, reason ADP_Stopped_ApplicationExit 0x20026.
 */
#include <stdint.h>

#include "board.h"

int main(void);
void board_start(void);
void board_fault(void);

extern uint32_t board_stack_top[], board_bss_start[], board_bss_end[];

static uint32_t semihosting(uint32_t operation, const void *argument)
{
    register uint32_t r0 __asm__("r0") = operation;
    register const void *r1 __asm__("r1") = argument;
    __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
    return r0;
}

void board_print(const char *text)
{
    semihosting(0x04, text);
}

static void board_exit(uint32_t status)
{
    const uint32_t block[2] = {0x20026, status};
    semihosting(0x20, block);
    for (;;)
        ;
}

void board_start(void)
{
    /* Full access to coprocessors 10 and 11, the floating-point unit, before the first instruction that uses it. */
    *(volatile uint32_t *)0xE000ED88 |= 0xFu << 20;
    __asm__ volatile("dsb\n\tisb" ::: "memory");
    for (uint32_t *word = board_bss_start; word < board_bss_end; word++)
        *word = 0;
    board_exit((uint32_t)main());
}

void board_fault(void)
{
    board_print("cortexm_start.c: the processor took a fault\n");
    board_exit(1);
}

/* Initial stack pointer, reset, then the 14 system exceptions. Nothing here uses interrupts. */
__attribute__((section(".vectors"), used)) static const uintptr_t vectors[16] = {
    (uintptr_t)board_stack_top, (uintptr_t)board_start, (uintptr_t)board_fault, (uintptr_t)board_fault,
    (uintptr_t)board_fault,     (uintptr_t)board_fault, (uintptr_t)board_fault, (uintptr_t)board_fault,
    (uintptr_t)board_fault,     (uintptr_t)board_fault, (uintptr_t)board_fault, (uintptr_t)board_fault,
    (uintptr_t)board_fault,     (uintptr_t)board_fault, (uintptr_t)board_fault, (uintptr_t)board_fault,
};
