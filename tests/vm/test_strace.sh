#!/bin/sh
# vm.strace: test_strace.sh PUPIL: boots the guest and traces 600 frames of `pupil run` there.
set -eu
. "$(dirname "$0")/amd64.sh"
command -v strace >/dev/null || {
    echo "skipped: no strace: the packages are listed in test.sh"
    exit 77
}
# The check itself: of twelve frames, the last three with two calls too many.
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
for i in 1 2 3 4 5 6 7 8 9 10 11 12; do
    echo "7 poll([{fd=3, events=POLLIN|POLLPRI}], 1, 100) = 1 ([{fd=3, revents=POLLIN}])"
    echo "7 ioctl(3, VIDIOC_DQBUF, {type=V4L2_BUF_TYPE_VIDEO_CAPTURE}) = 0"
    [ $i -le 9 ] || echo "@"
    echo "7 ioctl(3<socket:[9]>, VIDIOC_QBUF, {type=V4L2_BUF_TYPE_VIDEO_CAPTURE}) = 0"
done >"$work/log"
sed 's/@/7 poll([{fd=3, events=POLLIN|POLLPRI}], 1, 100) = 0 (Timeout)/' "$work/log" >"$work/good"
sh "$here/strace_check.sh" "$work/good" 12 >/dev/null || { echo "test_strace.sh: the check takes nothing"; exit 1; }
for call in "brk(NULL) = 0x5" "mmap(NULL, 4096) = 0x7" "ioctl(3, VIDIOC_QUERYCAP, {}) = 0" "futex(0x7, FUTEX_WAIT) = 0" \
    "openat(AT_FDCWD, \"x\") = 3" "poll([{fd=3}], 1, 100) = 1"; do
    sed "s|@|8 $call\n8 $call|" "$work/log" >"$work/bad"
    ! sh "$here/strace_check.sh" "$work/bad" 12 >/dev/null || { echo "test_strace.sh: $call is not found"; exit 1; }
done
! sh "$here/strace_check.sh" "$work/good" 13 >/dev/null || { echo "test_strace.sh: a frame is missing"; exit 1; }

in_guest "$here/strace_guest.sh" 600 "$1" run -d /dev/video0 --mode digital --width 320 \
    --height 180 --threads 1 -n 600 -q -o -
