/* A plugin for qemu: counts the instructions that a program executes between two marks. The mark is the system call
 * getppid, which no C library makes by itself: every second one prints the count since the one before. Counts repeat
 * exactly.
 *
 * With "blocks=on", each block that was executed in between follows: "block", address, instructions, how many times.
 *
 * Debian has no package with qemu's header, so the parts that are used are declared here (plugin API 1, qemu 4.2 and
 * later: docs/devel/tcg-plugins).
 */
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#define EXPORT          __attribute__((visibility("default")))
#define AARCH64_GETPPID 173 /* include/uapi/asm-generic/unistd.h of Linux */

typedef uint64_t plugin_id;
struct qemu_plugin_tb;

extern size_t qemu_plugin_tb_n_insns(const struct qemu_plugin_tb *block);
extern uint64_t qemu_plugin_tb_vaddr(const struct qemu_plugin_tb *block);
extern void qemu_plugin_register_vcpu_tb_trans_cb(plugin_id id,
                                                  void (*translated)(plugin_id id, struct qemu_plugin_tb *block));
/* operation 0 adds `value` to *counter each time before the block is executed */
extern void qemu_plugin_register_vcpu_tb_exec_inline(struct qemu_plugin_tb *block, int operation, void *counter,
                                                     uint64_t value);
typedef void syscall_callback(plugin_id id, unsigned cpu, int64_t number, uint64_t a1, uint64_t a2, uint64_t a3,
                              uint64_t a4, uint64_t a5, uint64_t a6, uint64_t a7, uint64_t a8);
extern void qemu_plugin_register_vcpu_syscall_cb(plugin_id id, syscall_callback *called);

EXPORT int qemu_plugin_version = 1;
EXPORT int qemu_plugin_install(plugin_id id, const void *info, int argc, char **argv);

static uint64_t executed, at_mark;
static int begun;

static int with_blocks;
static struct block {
    uint64_t address, instructions, executed, at_mark;
} blocks[1 << 16]; /* count_arm has some thousands */
static size_t block_count;

static void translated(plugin_id id, struct qemu_plugin_tb *block)
{
    (void)id;
    qemu_plugin_register_vcpu_tb_exec_inline(block, 0, &executed, qemu_plugin_tb_n_insns(block));
    if (!with_blocks || block_count == sizeof blocks / sizeof *blocks)
        return;
    struct block *b = &blocks[block_count++];
    b->address = qemu_plugin_tb_vaddr(block);
    b->instructions = qemu_plugin_tb_n_insns(block);
    qemu_plugin_register_vcpu_tb_exec_inline(block, 0, &b->executed, 1);
}

static void print_blocks(void)
{
    for (struct block *b = blocks; b < blocks + block_count; b++)
        if (b->executed != b->at_mark)
            printf("block %llx %llu %llu\n", (unsigned long long)b->address, (unsigned long long)b->instructions,
                   (unsigned long long)(b->executed - b->at_mark));
}

static void called(plugin_id id, unsigned cpu, int64_t number, uint64_t a1, uint64_t a2, uint64_t a3, uint64_t a4,
                   uint64_t a5, uint64_t a6, uint64_t a7, uint64_t a8)
{
    (void)id, (void)cpu, (void)a1, (void)a2, (void)a3, (void)a4, (void)a5, (void)a6, (void)a7, (void)a8;
    if (number != AARCH64_GETPPID)
        return;
    if (begun) {
        printf("%llu\n", (unsigned long long)(executed - at_mark));
        print_blocks();
        fflush(stdout);
    }
    begun = !begun;
    at_mark = executed;
    for (struct block *b = blocks; b < blocks + block_count; b++)
        b->at_mark = b->executed;
}

int qemu_plugin_install(plugin_id id, const void *info, int argc, char **argv)
{
    (void)info;
    with_blocks = argc > 0 && strcmp(argv[0], "blocks=on") == 0;
    qemu_plugin_register_vcpu_tb_trans_cb(id, translated);
    qemu_plugin_register_vcpu_syscall_cb(id, called);
    return 0;
}
