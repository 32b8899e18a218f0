#!/bin/sh
# arm64_guest.sh: in the guest of vm.arm64.
set -e
export MODPROBE=modprobe # busybox's, which has no -d; the modules are where it looks for them
capture_guest.sh capture smoke
pupil list | cut -c1-100
pupil run -d 2 --width 320 --height 180 --framerate 60 -n 20 -q --stats /run/run.csv
[ "$(wc -l </run/run.csv)" = 21 ] || {
    echo "FAILED: of 20 frames there are not as many lines"
    head -n 3 /run/run.csv
    exit 1
}
