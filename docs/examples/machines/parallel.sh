#!/bin/sh
# parallel.sh INPUT FRAMES RANGES OUT.mkv: pupil replay INPUT -o OUT.mkv by GNU parallel, in RANGES ranges of frames, on
# all processors of this machine ($PARALLEL may name others). Complete parts are not made again: after a crash, run it
# once more. $PUPIL: the program; $OPTIONS: settings of pupil replay, such as "--ev -0.5"; $KIND: format of the parts
# (mkv; with y4m, OUT is a .nut, because Matroska takes no raw RGB).
set -eu
[ $# = 4 ] || { echo "usage: sh parallel.sh INPUT FRAMES RANGES OUT.mkv" >&2; exit 2; }
input=$1 frames=$2 ranges=$3 out=$4
pupil=${PUPIL:-pupil} kind=${KIND:-mkv} OPTIONS=${OPTIONS:-}
for number in "FRAMES $frames" "RANGES $ranges"; do
    case ${number#* } in '' | 0* | *[!0-9]*)
        echo "parallel.sh: ${number%% *} must be a positive whole number, not '${number#* }'" >&2
        exit 2 ;;
    esac
done
[ "$ranges" -le "$frames" ] || ranges=$frames # no empty ranges
case $out in -*) out=./$out ;; esac
work=$out.parts

# The folder is for these settings only.
settings="$input $(if [ -f "$input" ]; then stat -c '%s %y' -- "$input"; fi)
$frames frames, $ranges ranges, $kind, $OPTIONS"
mkdir -p "$work"
if [ -n "$(ls -A "$work")" ] && [ "$(cat "$work/settings" 2>/dev/null)" != "$settings" ]; then
    echo "parallel.sh: $work is of another input or other settings: remove it to begin anew" >&2
    exit 1
fi
echo "$settings" >"$work/settings"

# "NUMBER FIRST..NEXT" a line; the last range has no end.
i=0
while [ $i -lt "$ranges" ]; do
    last=$((frames * (i + 1) / ranges))
    [ $((i + 1)) -lt "$ranges" ] || last=
    printf '%06d %s..%s\n' $i $((frames * i / ranges)) $last
    i=$((i + 1))
done >"$work/ranges"

# Workers get names in variables, never as part of a command's text.
export input work pupil kind OPTIONS
workers() { # COMMAND
    parallel --env input,work,pupil,kind,OPTIONS --colsep ' ' --retries 5 --halt soon,fail=1 "$1" :::: "$work/ranges"
}
workers '[ -e "$work/{1}.part" ] ||
    "$pupil" meter --range {2} -o "$work/{1}.part" --threads 1 -q $OPTIONS -- "$input"'
"$pupil" adapt "$work"/*.part -o "$work/curves" -y
workers '[ -e "$work/{1}.$kind" ] ||
    "$pupil" map --curves "$work/curves" --range {2} -o "$work/{1}.$kind" --threads 1 -q -- "$input"'
(
    cd "$work"
    printf 'file %s\n' *."$kind" >list
    ffmpeg -loglevel error -y -f concat -safe 0 -i list -c copy "joined.${out##*.}"
)
mv "$work/joined.${out##*.}" "$out"
