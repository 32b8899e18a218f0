#!/bin/sh
# vm.uvc: test_uvc.sh TEST CAMERA NODE FULL: boots the guest and runs uvc.c and the program there, with the camera. With
# PUPIL_PLOTS=FOLDER the plots of these runs are put there, for people.
set -eu
. "$(dirname "$0")/amd64.sh"
if [ -z "${PUPIL_PLOTS:-}" ]; then
    in_guest "$here/uvc_guest.sh" "$@" "$PUPIL_PROGRAM"
    exit
fi
mkdir -p "$PUPIL_PLOTS"
status=0
in_guest "$here/uvc_guest.sh" "$@" "$PUPIL_PROGRAM" plots >"$PUPIL_PLOTS/log" || status=$?
for name in $(sed -n 's/^plot //p' "$PUPIL_PLOTS/log"); do
    sed -n "/^plot $name\$/,/^end of plot/p" "$PUPIL_PLOTS/log" | sed '1d;$d' | base64 -d | gzip -d >"$PUPIL_PLOTS/$name"
done
sed '/^plot /,/^end of plot/d' "$PUPIL_PLOTS/log"
exit $status
