#!/bin/sh
# uvc_pair_guest.sh CAMERA NODE PUPIL: in the guest of vm.uvc_pair: two USB cameras on the kernel's uvcvideo, the second
# a stop more sensitive, run as one; for a while the light of both is eight times as strong. Prints their figures.
set -u
camera=$1 node=$2 pupil=$3
. "$(dirname "$0")/uvc_plug.sh"
cd "$TMPDIR" || exit 1
modprobe -d "$MODULES" vhci-hcd
modprobe -d "$MODULES" uvcvideo
# a port of vhci_hcd may answer EBUSY when it should resume
echo -1 >/sys/module/usbcore/parameters/autosuspend
plug linear
first=$plugged first_path=$path
"$camera" linear second &
second=$!
for _ in $(seq 200); do
    second_path=$("$node" find uvcvideo capture 1) && break
    sleep 0.1
done
"$node" set "$second_path" "Auto Exposure" 3
"$node" set "$second_path" Gain 40
echo "the cameras: $first_path $second_path"

"$pupil" run -d "$first_path" -d "$second_path" --camera-ev 1 --width 320 --height 240 --framerate 5 --mode sensor -t 200 \
    --meter-rows 4 --curve linear --stats s%i.csv &
runner=$!
sleep 28
"$node" light $first 9
"$node" light $second 9
sleep 16
"$node" light $first 8
"$node" light $second 8
sleep 16
kill -TERM $runner
wait $runner
status=$?
for i in 0 1; do
    echo "figures $i"
    cat s$i.csv
    echo "end of figures"
done
left=0
for path in "$first_path" "$second_path"; do
    is_put_back || left=1
done
kill -TERM $first $second
wait
[ $status = 0 ] || { echo "pupil run: exit $status"; exit 1; }
[ $left = 0 ] || { echo "the controls are not put back"; exit 1; }
