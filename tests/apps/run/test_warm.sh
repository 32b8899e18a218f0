#!/bin/sh
# pupil run begins with the exposure of this camera's last run, without an option: where it is kept, that no fault there
# ends a run, and how many frames it saves. Needs $PUPIL_RUN_FAKE (tests/apps/run_fake.c).
set -u
. "$(dirname "$0")/../../lib.sh"
use_fake_camera
unset STATE_DIRECTORY XDG_STATE_HOME

# run ARGUMENTS...: the camera is far too bright as its user left it
run() { call 0 "" fake:flat=600 fake:light=12@1 --mode sensor "$@"; }
# off_key FILE.csv: how many of its frames are not at the key of 0.18
off_key() {
    awk -F, '{ sub(/\r$/, "") } NR == 1 { for (i = 1; i <= NF; i++) if ($i == "output_level") n = i; next }
        $n < 0.165 || $n > 0.195 { off++ } END { print off + 0 }' "$1"
}
warm() { grep -q "from the exposure of its last run" said.err; }

export HOME="$room/home"
run -n 90 --stats cold.csv
warm && fail "the first run is warm"
[ -f home/.local/state/pupil/cameras ] || fail "nothing is kept: $(find . | tr '\n' ' ')"
[ "$(stat -c %a home/.local/state/pupil)" = 700 ] || fail "the folder is open to others"
run -n 90 --stats warm.csv
warm || fail "the second run is cold: $(cat said.err)"
echo "frames that are not at the key, of 90: cold $(off_key cold.csv), warm $(off_key warm.csv)"
[ "$(off_key cold.csv)" -ge 3 ] && [ "$(off_key warm.csv)" = 0 ] || fail "cold $(off_key cold.csv), warm $(off_key warm.csv)"
run -n 90 --no-resume
warm && fail "--no-resume is warm"
call 2 "--resume and --no-resume: one of them" --resume file --no-resume
call 0 "" fake:flat=600 --mode digital -n 5
warm && fail "digital is warm"

# the other places: the first that is set
export XDG_STATE_HOME="$room/state"
run -n 90
[ -f state/pupil/cameras ] && ! warm || fail "XDG_STATE_HOME: $(find . | tr '\n' ' ')"
export STATE_DIRECTORY="$room/unit/pupil:$room/second"
run -n 90
[ -f unit/pupil/cameras ] && ! warm || fail "STATE_DIRECTORY: $(find . | tr '\n' ' ')"
run -n 5
warm || fail "STATE_DIRECTORY: $(cat said.err)"
unset STATE_DIRECTORY
XDG_STATE_HOME=relative HOME= run -n 90 --stats none.csv
[ ! -e relative ] && ! warm || fail "a relative path: $(find . | tr '\n' ' ')"
XDG_STATE_HOME=/dev/null run -n 5
[ "$(wc -l <said.err)" = 3 ] || fail "no folder: $(cat said.err)"

# a setting that does not fit, a damaged file, a file of something else
printf '%s\n9000\tfake\tfake:1\tFake Camera\n' "$(head -n 1 state/pupil/cameras)" >state/pupil/cameras
call 0 "cameras: 9e+03 s of exposure time x gain is none that this camera has; it is not used" fake:flat=600 -n 90
warm && fail "9000 s fit"
run -n 5
warm || fail "what did not fit was not replaced: $(cat state/pupil/cameras)"
printf '%s\n0.5\tfa' "$(head -n 1 state/pupil/cameras)" >state/pupil/cameras
call 0 "cameras: is damaged; it says nothing of this camera" fake:flat=600 -n 90
echo "a diary" >state/pupil/cameras
call 0 "cameras: was not written by --resume, and is left as it is; name another one: --resume FILE" fake:flat=600 -n 90
[ "$(cat state/pupil/cameras)" = "a diary" ] || fail "another file is overwritten"

end_test
