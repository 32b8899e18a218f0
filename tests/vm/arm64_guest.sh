#!/bin/sh
# arm64_guest.sh: in the guest of vm.arm64, after vivid was loaded.
set -e
capture smoke
pupil list | cut -c1-100
pupil run -d 0 --width 320 --height 180 --framerate 60 -n 20 -q --stats /run/run.csv
[ "$(wc -l </run/run.csv)" = 21 ] || {
    echo "FAILED: of 20 frames there are not as many lines"
    head -n 3 /run/run.csv
    exit 1
}
