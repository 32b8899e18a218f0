#!/bin/sh
# absent.sh BUILD: builds the program without its libraries into BUILD. It works with the rest, and says what is
# missing.
set -eu
sh "$(dirname "$0")/nested.sh" "$1" pupil - -- --preset release -DPUPIL_WERROR=ON \
    -DPUPIL_MEDIA=OFF -DPUPIL_V4L2=OFF
program=$1/apps/pupil
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
status=0

# refuses OPTION ARGUMENTS...: the program fails, names the option, and leaves no output
refuses() {
    option=$1
    shift
    if "$program" "$@" >"$work/said" 2>&1 </dev/null; then
        echo "FAILED: pupil $* succeeds without $option"
        status=1
    elif ! grep -q "$option=OFF" "$work/said"; then
        echo "FAILED: pupil $* does not name $option=OFF: $(cat "$work/said")"
        status=1
    else
        echo "pupil says: $(cat "$work/said")"
    fi
    [ -z "$(find "$work" -name 'out*' -o -name '.out*')" ] || {
        echo "FAILED: pupil $* leaves $(find "$work" -name 'out*' -o -name '.out*')"
        status=1
    }
}

"$program" replay synth:walk --frames 3 -q -o "$work/walk.y4m"
[ -s "$work/walk.y4m" ] || { echo "FAILED: no Y4M"; status=1; }
mkdir "$work/shots" # a recording, by the first thing that is checked
echo '{}' >"$work/shots/recording.json"

printf '\166\057\061\001 EXR by its first bytes' >"$work/a.exr"
printf '\211PNG\r\n\032\n PNG by its first bytes' >"$work/a.png"
cp "$work/a.png" "$work/a.mkv"
refuses PUPIL_MEDIA replay "$work/a.exr" -q -o "$work/out.y4m"
refuses PUPIL_MEDIA replay "$work/a.png" -q -o "$work/out.y4m"
refuses PUPIL_MEDIA replay "$work/a.mkv" -q -o "$work/out.y4m"
refuses PUPIL_MEDIA replay synth:walk --frames 1 -q -o "$work/out.png"
refuses PUPIL_MEDIA replay synth:walk --frames 1 -q -o "$work/out.mp4"
refuses PUPIL_MEDIA replay synth:walk --frames 1 -q --stats "$work/out.jsonl"
refuses PUPIL_V4L2 run -d libcamera:0
refuses PUPIL_V4L2 replay v4l2:0 -q -o "$work/out.y4m"
refuses PUPIL_V4L2 replay /dev/video0 -q -o "$work/out.y4m"
refuses PUPIL_MEDIA record synth:walk -n 1 "$work/out"
refuses PUPIL_MEDIA replay "$work/shots" -q -o "$work/out.y4m"
refuses PUPIL_V4L2 list
refuses PUPIL_V4L2 probe
refuses PUPIL_V4L2 probe -d 0
refuses PUPIL_MEDIA probe --json
refuses PUPIL_V4L2 record "$work/out"
refuses PUPIL_V4L2 record -d 0 --format YUYV "$work/out"
refuses PUPIL_MEDIA list --json
refuses PUPIL_LAB render room -q -o "$work/out.y4m"
refuses PUPIL_LAB study -q
refuses PUPIL_LAB sim -q
refuses PUPIL_LAB bench scene
exit $status
