#!/bin/sh
# vm.gstreamer: test_gstreamer.sh CAMERA NODE PLUGIN: boots the guest and runs pipelines on uvcvideo and vivid there.
# With PUPIL_PLOTS=FOLDER its pictures are put there, for people.
set -eu
. "$(dirname "$0")/amd64.sh"
command -v gst-launch-1.0 >/dev/null || { echo "skipped: no gst-launch-1.0: the packages are listed in test.sh"; exit 77; }
plugins=$(pkg-config --variable=pluginsdir gstreamer-1.0)
for plugin in coreelements video4linux2 x264 matroska png multifile; do
    [ -e "$plugins/libgst$plugin.so" ] || { echo "skipped: no $plugin: the packages are listed in test.sh"; exit 77; }
done
status=0
log=$(mktemp)
trap 'rm -f "$log"' EXIT
in_guest "$here/gstreamer_guest.sh" "$@" "$plugins" "$PUPIL_PROGRAM" ${PUPIL_PLOTS:+plots} >"$log" || status=$?
for name in $(sed -n 's/^plot //p' "$log"); do
    sed -n "/^plot $name\$/,/^end of plot/p" "$log" | sed '1d;$d' | base64 -d >"$PUPIL_PLOTS/$name"
done
sed '/^plot /,/^end of plot/d' "$log"
exit $status
