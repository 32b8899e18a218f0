#!/bin/sh
# strace_guest.sh FRAMES PROGRAM ARGUMENTS...: in the guest, with one webcam of vivid's: runs the program under strace,
# and says which system calls it makes while it streams: from the tenth frame on, in all of its threads. Any call other
# than waiting for a frame, taking it, giving it back, writing to a control or writing an output fails.
set -eu
frames=$1
shift
modprobe -d "$MODULES" vivid n_devs=1 node_types=0x1 num_inputs=1 input_types=0
trace=$TMPDIR/trace
strace -f -s 0 -o "$trace" "$@" >/dev/null || { echo "strace_guest.sh: $*: exit $?"; exit 1; }
exec sh "$(dirname "$0")/strace_check.sh" "$trace" "$frames"
