#!/bin/sh
# strace_check.sh LOG FRAMES: what `strace -f -o LOG` saw between the 10th frame and the last of so many: the number of
# each call. Fails if there is a call that a frame does not need, or one more than once a frame (except for controls and
# outputs).
#
# clock_gettime is not a system call if the kernel provides its clock to processes; emulated machines have no such
# clock.
exec awk -v frames="$2" '
function name_of(line) {
    sub(/^[0-9]+ +/, "", line)
    if (line ~ /^(---|\+\+\+|<\.\.\.)/) # signals, exits, ends of earlier calls
        return ""
    if (line ~ /^p?poll\(.* = 0 \(Timeout\)/) # no frame came: at most ten times a second, regardless of frames
        return ""
    if (line ~ /^ioctl\(/) {
        sub(/^ioctl\([0-9]+(<[^>]*>)?, /, "", line)
        sub(/[^A-Z0-9_].*/, "", line)
        return line
    }
    sub(/[^a-z0-9_].*/, "", line)
    return line
}
{
    name = name_of($0)
    if (name == "")
        next
    if (name == "VIDIOC_DQBUF" && ++taken == 10) {
        for (known in count)
            delete count[known]
    }
    if (name == "VIDIOC_STREAMOFF")
        exit
    count[name]++
    if (!(name in first) && taken >= 10)
        first[name] = $0
    if (taken == frames && name == "VIDIOC_DQBUF") { # what follows may be the end
        for (known in count)
            total[known] = count[known]
    }
}
END {
    steady = frames - 10
    once = " poll ppoll VIDIOC_DQBUF VIDIOC_QBUF DMA_BUF_IOCTL_SYNC "
    free = " VIDIOC_S_CTRL VIDIOC_S_EXT_CTRLS VIDIOC_G_CTRL VIDIOC_G_EXT_CTRLS write writev clock_gettime "
    if (taken < frames) {
        printf "strace_check.sh: %d frames were taken, not %d\n", taken, frames
        exit 1
    }
    for (known in total) {
        printf "%s %d\n", known, total[known]
        if (index(free, " " known " "))
            continue
        if (!index(once, " " known " ")) {
            printf "strace_check.sh: no frame needs this: %s\n", first[known]
            failed = 1
        } else if (total[known] > (known == "DMA_BUF_IOCTL_SYNC" ? 2 : 1) * steady + 2) {
            printf "strace_check.sh: %s: %d times in %d frames\n", known, total[known], steady
            failed = 1
        }
    }
    exit failed
}' "$1"
