/* A plugin for qemu: counts the instructions that a program executes between two marks. The mark is the system call
 * getppid, which no C library makes by itself: at every second one the number since the one before goes to standard
 * output. Counts repeat exactly.
 *
 * Debian has no package with qemu's header, so what is used of it is declared here (plugin API 1, qemu 4.2 and later:
 * docs/devel/tcg-plugins).
 */
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#define EXPORT          __attribute__((visibility("default")))
#define AARCH64_GETPPID 173 /* include/uapi/asm-generic/unistd.h of Linux */

typedef uint64_t plugin_id;
struct qemu_plugin_tb;

extern size_t qemu_plugin_tb_n_insns(const struct qemu_plugin_tb *block);
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

static void translated(plugin_id id, struct qemu_plugin_tb *block)
{
    (void)id;
    qemu_plugin_register_vcpu_tb_exec_inline(block, 0, &executed, qemu_plugin_tb_n_insns(block));
}

static void called(plugin_id id, unsigned cpu, int64_t number, uint64_t a1, uint64_t a2, uint64_t a3, uint64_t a4,
                   uint64_t a5, uint64_t a6, uint64_t a7, uint64_t a8)
{
    (void)id, (void)cpu, (void)a1, (void)a2, (void)a3, (void)a4, (void)a5, (void)a6, (void)a7, (void)a8;
    if (number != AARCH64_GETPPID)
        return;
    if (begun) {
        printf("%llu\n", (unsigned long long)(executed - at_mark));
        fflush(stdout);
    }
    begun = !begun;
    at_mark = executed;
}

int qemu_plugin_install(plugin_id id, const void *info, int argc, char **argv)
{
    (void)info, (void)argc, (void)argv;
    qemu_plugin_register_vcpu_tb_trans_cb(id, translated);
    qemu_plugin_register_vcpu_syscall_cb(id, called);
    return 0;
}
