/* apps/run/notify.h: notifies a service manager of a run's state, by the protocol of sd_notify(3): a datagram to the
 * socket that $NOTIFY_SOCKET names. READY=1 when the exposure has converged, STATUS= when the state changes, WATCHDOG=1
 * while frames come (at most two in the time of $WATCHDOG_USEC), STOPPING=1 at the end.
 *
 * Nothing here waits: a message that the socket does not take at once is dropped, except READY=1, which is sent again
 * with the next frame.
 */
#ifndef PUPIL_APPS_RUN_NOTIFY_H
#define PUPIL_APPS_RUN_NOTIFY_H

#include <stdint.h>

#include "output/frame_log.h"
#include "pupil/error.h"

typedef struct run_notify {
    int fd;              /* -1: nobody listens, and all calls do nothing */
    int is_ready;        /* READY=1 was sent */
    int64_t watchdog_ns; /* between two WATCHDOG=1; 0: none is expected */
    int64_t alive_ns;    /* of the last WATCHDOG=1 */
    char status[160];    /* sent last, only state and reason */
} run_notify;

/* By the environment. If it names a socket that cannot be reached, `warning` is a sentence, else empty. */
void run_notify_open(run_notify *n, pupil_why *warning);

/* After each frame; by CLOCK_MONOTONIC. */
void run_notify_frame(run_notify *n, int is_at_rest, const frame_log_entry *entry, int64_t now_ns);

/* The run ends. */
void run_notify_close(run_notify *n);

#endif
