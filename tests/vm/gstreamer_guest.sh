#!/bin/sh
# gstreamer_guest.sh CAMERA NODE PLUGIN PLUGINS PUPIL [plots]: in the guest of vm.gstreamer. pupilsrc and v4l2src ! pupilae
# on a USB camera, docs/examples/gstreamer_h264.sh, an unplugged camera, raw frames of vivid. PLUGIN is pupil's file,
# PLUGINS the folder of GStreamer's.
set -u
camera=$1 node=$2 pupil=$5 plots=${6:-}
example=$(cd "$(dirname "$0")/../.." && pwd)/docs/examples/gstreamer_h264.sh
. "$(dirname "$0")/uvc_plug.sh"
cd "$TMPDIR" || exit 1
failures=0
modprobe -d "$MODULES" vhci-hcd
modprobe -d "$MODULES" uvcvideo
modprobe -d "$MODULES" vivid n_devs=1 node_types=0x1 num_inputs=1 input_types=0 ccs_cap_mode=0

# Only the plugins that are used: an emulated machine takes minutes to scan all.
mkdir plugins
ln -s "$3" plugins/
for plugin in coreelements video4linux2 x264 matroska png multifile; do
    ln -s "$4/libgst$plugin.so" plugins/
done
export GST_PLUGIN_SYSTEM_PATH="$PWD/plugins" GST_REGISTRY="$PWD/registry" GST_REGISTRY_FORK=no

fail() {
    echo "FAILED: $*"
    failures=$((failures + 1))
}

# show NAME: a picture, for people
show() {
    [ -z "$plots" ] || { echo "plot $1"; base64 <"$1"; echo "end of plot"; }
}

# until_messages N WORDS FILE: so many lines have these words; a busy machine takes a while
until_messages() {
    for _ in $(seq 300); do
        [ "$(grep -c -- "$2" "$3")" -lt "$1" ] || return 0
        sleep 0.3
    done
    fail "no $1 messages of '$2': $(grep pupilsrc "$3" | tail -n 5)"
}

# middle FILE: luma in the middle of its last NV12 frame of 320x240
middle() {
    tail -c 115200 "$1" | tail -c +$((120 * 320 + 160 + 1)) | head -c 1 | od -An -tu1 | tr -d ' '
}

# --- pupilsrc: light, eight times the light, and back ---
plug display slow
gst-launch-1.0 --no-position -m pupilsrc device="$path" ! video/x-raw,format=NV12,width=320,height=240 ! filesink location=frames.nv12 \
    >messages 2>&1 &
runner=$!
until_messages 1 "state=(string)converged" messages
for light in 9 8; do
    "$node" light $plugged $light
    before=$(grep -c "state=(string)converged" messages)
    until_messages $((before + 1)) "state=(string)converged" messages
    sleep 2
    kill -0 $runner || fail "gst-launch-1.0 ended: $(tail -n 5 messages)"
    level=$(middle frames.nv12)
    # 0.18 is sRGB 118, which is 117 in limited range; the ramp's middle is brighter than its log-average by its step
    [ "${level:-0}" -gt 90 ] && [ "$level" -lt 135 ] || fail "light $light: the picture's middle is at $level"
    echo "pupilsrc, light $light: the picture's middle is at $level"
done
kill -INT $runner
wait $runner
is_put_back || fail "pupilsrc: the controls are not put back"
grep "pupilsrc, running-time" messages | sed 's/.*pupilsrc, //' | head -n 12

# --- v4l2src ! pupilae ---
timeout 120 gst-launch-1.0 --no-position -q v4l2src device="$path" num-buffers=10 ! video/x-raw,width=320,height=240 ! pupilae ! \
    video/x-raw,format=RGB ! filesink location=frames.rgb || fail "v4l2src ! pupilae: exit $?"
[ "$(wc -c <frames.rgb)" = $((10 * 320 * 240 * 3)) ] || fail "v4l2src ! pupilae: $(wc -c <frames.rgb) bytes"

# --- the example ---
timeout 200 sh "$example" "$path" camera.mkv 20 >messages 2>&1 || fail "the example: $(tail -n 3 messages)"
"$pupil" replay camera.mkv -q --stats stats.csv || fail "the example's video"
frames=$(($(wc -l <stats.csv) - 1))
[ $frames -ge 5 ] && [ $frames -le 20 ] || fail "the example's video has $frames frames"
is_put_back || fail "the example: the controls are not put back"
echo "the example's video has $frames frames"

# --- unplugged ---
gst-launch-1.0 --no-position pupilsrc device="$path" ! identity silent=false ! fakesink -v >messages 2>&1 &
runner=$!
until_messages 3 "chain" messages
kill -TERM $plugged
wait $plugged
wait $runner && fail "unplugged: exit 0"
[ "$(grep -c "ERROR: from element" messages)" = 1 ] || fail "unplugged: $(grep ERROR messages)"
grep -q "the camera was unplugged" messages || fail "unplugged: $(tail -n 5 messages)"
grep "ERROR: from element" messages

# --- raw frames ---
webcam=$("$node" find vivid capture 0)
timeout 120 gst-launch-1.0 --no-position -q pupilsrc device="$webcam" sensor-format=RGGB num-buffers=8 ! \
    video/x-raw,format=RGB,width=320,height=180 ! pngenc ! multifilesink location=raw-%02d.png || fail "raw: exit $?"
[ -s raw-07.png ] && show raw-07.png || fail "no raw-07.png"

echo "$failures failures"
[ "$failures" = 0 ]
