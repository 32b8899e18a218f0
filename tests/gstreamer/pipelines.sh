#!/bin/sh
# gstreamer.pipelines: the plugin as a user sees it: gst-inspect-1.0, pipelines of gst-launch-1.0, the example.
here=$(cd "$(dirname "$0")" && pwd)
. "$here/../lib.sh"
needs gst-launch-1.0 gst-inspect-1.0
folder=$(pkg-config --variable=pluginsdir gstreamer-1.0)
export GST_PLUGIN_SYSTEM_PATH="$room/plugins" GST_REGISTRY="$room/registry"
mkdir plugins
for plugin in coreelements videotestsrc videoconvertscale videorate png multifile video4linux2; do
    [ -e "$folder/libgst$plugin.so" ] || skip "no GStreamer plugin $plugin: the packages are listed in test.sh"
    ln -s "$folder/libgst$plugin.so" plugins/
done

for element in pupilae pupilsrc; do
    gst-inspect-1.0 $element >inspected 2>said || fail "gst-inspect-1.0 $element: $(cat said)"
    [ ! -s said ] || fail "gst-inspect-1.0 $element says: $(cat said)"
    for word in "Element Properties" ae-lock exposure-value "Source module *pupil" "License *BSD"; do
        grep -q "$word" inspected || fail "gst-inspect-1.0 $element has no '$word'"
    done
done

# launch PIPELINE...: it plays to its end
launch() { timeout 60 gst-launch-1.0 -q "$@" >said 2>&1 </dev/null || fail "$*: $(cat said)"; }
# Each format by itself, odd sizes, tiny frames
for format in P010_10LE I420_10LE Y444_16LE NV12 YV12 NV21 NV16 YUY2 UYVY RGBA BGRx BGR GRAY16_LE GRAY8; do
    launch videotestsrc num-buffers=2 ! video/x-raw,format=$format,width=33,height=17 ! pupilae ! fakesink
done
launch videotestsrc num-buffers=2 ! video/x-raw,width=1,height=1 ! pupilae ! fakesink
# With the usual neighbours in a pipeline; two in one pipeline; another size in between
launch videotestsrc num-buffers=9 ! videoconvert ! pupilae ! videoconvert ! pupilae ! videoscale ! \
    video/x-raw,width=64,height=48 ! pupilae ! pngenc ! multifilesink location=%d.png
[ -s 8.png ] || fail "no 8.png"
launch videotestsrc num-buffers=3 ! video/x-raw,format=I420_10LE,colorimetry=bt2100-pq ! pupilae ! video/x-raw,format=RGB ! \
    pngenc ! multifilesink location=pq%d.png
[ -s pq2.png ] || fail "no pq2.png"
# linear 16-bit RGB is not read: it is converted before
launch videotestsrc num-buffers=2 ! video/x-raw,format=ARGB64 ! videoconvert ! pupilae ! fakesink

# refuses WORDS PIPELINE...: one error, in these words. gst-launch-1.0 1.22 may wait forever after an error before the
# first picture (as with identity error-after=1), so it is killed.
refuses() {
    words=$1
    shift
    timeout 5 gst-launch-1.0 "$@" >said 2>&1 </dev/null && fail "$* plays"
    [ "$(grep -c "ERROR: from element.*$words" said)" = 1 ] || fail "$*: no '$words' in $(cat said)"
}
refuses "8-bit RGB is read as sRGB" videotestsrc ! "video/x-raw,format=RGB,colorimetry=(string)1:1:14:7" ! pupilae ! fakesink
refuses "is not there" pupilsrc device=/dev/video987 ! fakesink
example=$here/../../docs/examples/gstreamer_h264.sh
[ "$(wc -l <"$example")" -le 40 ] || fail "gstreamer_h264.sh is longer than 40 lines"
end_test
