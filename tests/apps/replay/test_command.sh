#!/bin/sh
# The program as a user sees it: outputs complete or absent, clear sentences, exit codes, the same bits at any number of
# threads. Needs $PUPIL_PROGRAM; runs in a folder of its own.
set -u
. "$(dirname "$0")/../../lib.sh"
use_pupil

walk="replay synth:walk --size 64x36 -q"

# help and usage
"$program" replay --help >help.txt || fail "--help does not exit 0"
help_fits 52 90 help.txt
expect 2 "no such command" nonsense
expect 2 "no input" replay
expect 2 "--metreing" replay synth:walk --metreing spot
for bad in "--key 2" "--fps 0" "--fps nan" "--fps 1x" "--size 0x4" "--size 64" "--trim 95,5" "--trim 5" "--meter-rows 3" "--meter-rows 16" "--roi 0.5,0.5,0.6,0.1" \
    "--formula 5" "--weight 0.1" "--white dark" "--white 0" "--ev 17" "--tau-light -1" "--metering moon" "--transfer pq" \
    "--eye 0" "--eye 1e10" "--eye dark" "--threads 1000" "--hold 0" "--frames -3" "--frames 0"; do
    # shellcheck disable=SC2086 # two words
    expect 2 "${bad%% *}" replay synth:walk $bad
done
expect 2 "--eye and --formula" replay synth:walk --eye 1 --formula 2
expect 2 "not with --eye" replay synth:walk --eye 1 --tau-dark 2
expect 2 "not with --eye" replay synth:walk --eye 1 --weight 0.1
expect 2 "named for two outputs" replay synth:walk -o a.mp4 -o a.mp4
expect 2 "named for two outputs" replay synth:walk -o a.mp4 -o ./a.mp4
expect 2 "named for two outputs" replay synth:walk -o frames -o frames/
mkdir empty
expect 2 "empty/s.csv: is inside empty," $walk -n 2 -o empty --stats empty/s.csv
expect 2 "./new/deep/s.csv: is inside new/," $walk -n 2 -o new/ --stats ./new/deep/s.csv
expect 2 "report/p.svg: is inside report," $walk -n 2 --report report --plot report/p.svg
rmdir empty
absent new report

# wrong inputs
expect 1 "missing.exr" replay missing.exr -o a.mp4
expect 1 "the name of an input is empty" replay "" -o a.mp4
expect 1 "files are read, not addresses: ffmpeg -i 'rtsp://cam/1' -map 0:v -c copy -f matroska - | pupil" replay rtsp://cam/1 -o a.mp4
expect 1 "miss?ing?.exr" replay "$(printf 'miss\ning\033.exr')" -o a.mp4
expect 1 "walk" replay synth:run -o a.mp4
echo "not a picture" >text.exr
expect 1 "text.exr" replay text.exr -o a.png
expect 1 "a.txt" $walk -n 2 -o a.txt
expect 1 "nowhere" $walk -n 2 -o nowhere/a.mp4
expect 1 "one picture" $walk -n 2 -o a.png
expect 1 ".svg or a .png" $walk -n 2 -o a.mp4 --plot a.jpg
expect 1 "nowhere" $walk -n 2 -o a.mp4 --plot nowhere/a.svg
PATH=/nowhere "$program" $walk -n 2 -o a.mp4 --plot a.svg 2>said.err && fail "a plot without gnuplot"
grep -q "needs gnuplot" said.err || fail "no gnuplot: $(cat said.err)"
absent a.mp4 a.png a.txt a.svg

# every kind of output
expect 0 "" $walk -n 12 -o a.mp4 -o a.mkv -o a.y4m -o folder --stats s.jsonl --plot p.svg --report report
for made in a.mp4 a.mkv a.y4m folder/frame_000000.png folder/frame_000011.png s.jsonl p.svg report/index.html; do
    [ -s "$made" ] || fail "$made is not there"
done
[ "$(wc -l <s.jsonl)" = 12 ] || fail "s.jsonl has $(wc -l <s.jsonl) lines"
expect 1 "folder" $walk -n 2 -o folder
expect 0 "" $walk -n 2 -o folder -y
[ ! -e folder/frame_000002.png ] || fail "an overwritten folder keeps old frames"
expect 0 "" $walk -n 1 -o one.png
"$program" $walk -n 5 -o - >stream.y4m 2>said.err || fail "stdout: $(cat said.err)"
[ "$(head -c 9 stream.y4m)" = YUV4MPEG2 ] || fail "stdout is no Y4M"
"$program" $walk -n 5 -o stream2.y4m
cmp -s stream.y4m stream2.y4m || fail "stdout and a file differ"
for large in a.mp4 stream.y4m; do
    expect 1 "$large: frames of 64 x 36 pixels; at most 2303 pixels can be read" replay $large --max-pixels 2303 -o no.mp4
done
head -c 6912 a.y4m >large.raw
{ printf 'PF\n64 32\n-1.0\n' && head -c 24576 /dev/zero; } >dark.pfm
for large in "synth:walk --size 64x36" "pan:dark.pfm --size 64x36" raw:large.raw,format=RGB3,size=64x36; do
    name=${large%%[ ,]*}
    expect 0 "" replay $large -n 1 --max-pixels 2304 -o yes.png -q
    expect 1 "$name: frames of 64 x 36 pixels; at most 2303 pixels can be read" \
        replay $large -n 1 --max-pixels 2303 -o no.png
    absent no.png
    rm yes.png
done

# existing files are kept, unless -y
for made in a.mp4 a.y4m one.png one.tif s.jsonl s.json p.svg; do
    echo mine >$made
    option=-o
    [ "${made%%.*}" = s ] && option=--stats
    [ $made = p.svg ] && option=--plot
    expect 2 "$made: is there already; -y replaces it, and ${made%.*}-1.${made##*.} is free" $walk -n 1 $option $made
    [ "$(cat $made)" = mine ] || fail "$made was replaced"
    expect 0 "" $walk -n 1 $option $made -y
    [ "$(head -n 1 $made | head -c 4)" != mine ] || fail "$made was not replaced by -y"
done

# a folder that is not writable, as a user other than root
chmod 755 . && mkdir readonly && echo mine >readonly/kept.mp4 && chmod 555 readonly
cp "$program" ./pupil
as_user=
[ "$(id -u)" != 0 ] || as_user="setpriv --reuid=65534 --regid=65534 --clear-groups"
for option in "-o readonly/a.mp4" "-o readonly/a.png" "-o readonly/folder" "-o readonly/a.y4m" "--stats readonly/s.jsonl" \
    "--report readonly/r" "-o readonly/kept.mp4 -y" "-o readonly/a.tif" "--plot readonly/p.svg"; do
    # shellcheck disable=SC2086 # words
    $as_user ./pupil $walk -n 1 $option </dev/null >said.out 2>said.err && fail "$option: written into a read-only folder"
    grep -q "readonly" said.err || fail "$option: $(cat said.err)"
done
[ "$(ls -A readonly) $(cat readonly/kept.mp4)" = "kept.mp4 mine" ] || fail "a read-only folder: $(ls -A readonly)"
chmod 755 readonly && rm -r readonly pupil
# A file that appears during the run.
"$program" replay synth:walk --size 64x36 -n 9000 --hold 100 -o late.y4m 2>said.err &
running=$!
until_true "no pending file" eval 'ls .late.y4m.*.part >said.out 2>&1'
echo mine >late.y4m
ends 1
[ "$(cat late.y4m)" = mine ] && [ "$(head -c 9 late-1.y4m)" = YUV4MPEG2 ] &&
    grep -q "late.y4m: was made by another program in the meantime; .* as late-1.y4m" said.err ||
    fail "a late file: $(cat said.err)"

# on a terminal the progress line stays on one line
env TERM=xterm script -qec "stty cols 60; '$program' replay synth:walk --size 64x36 -n 2" said.out >said.err 2>&1
tr '\r' '\n' <said.out | sed 's/^.\[K//' | grep '^frame ' >lines || fail "no progress line: $(cat -v said.out)"
awk 'length($0) > 59 { exit 1 }' lines || fail "a progress line of over 59 characters: $(cat lines)"

# an output is not an input
"$program" $walk -n 2 -o in.y4m
cp in.y4m before.y4m
expect 2 "is also an input" replay in.y4m -o in.y4m
cmp -s in.y4m before.y4m || fail "the input was touched"
"$program" $walk -n 3 -o taken
for input in taken 'taken/*.png' taken/frame_000001.png; do
    expect 2 "is also an input" replay "$input" -o taken -y
done
[ -s taken/frame_000002.png ] || fail "a folder of inputs was replaced"
"$program" replay synth:walk --size 64x36 -n 1 -o "$(printf '\033[7m.y4m')" 2>said.err
grep -q '; ?\[7m.y4m$' said.err || fail "the name of an output steers the terminal: $(cat -v said.err)"
for input in taken 'taken/*.png'; do
    expect 2 "is also an input" replay "$input" -o taken/frame_000001.png -n 1 -y
done
expect 2 "is also an input" replay raw:in.y4m,format=GREY,size=8x8 -o in.y4m -y
cp in.y4m 'a,b.y4m'
expect 2 "a,b.y4m: is also an input" replay pan:a,b.y4m,fov=60 -o a,b.y4m -y
expect 2 "in.y4m: is also an input" replay pan:in.y4m -o in.y4m -y
echo "5 0.03" >lens
expect 2 "lens: is also an input" $walk -n 1 --veil lens --fov 50 --stats lens -y
"$program" replay - -o in.y4m -n 1 -y <in.y4m 2>said.err && fail "standard input was replaced"
cmp -s in.y4m before.y4m || fail "the input was replaced"
"$program" record in.y4m recorded -q
expect 2 "is also an input" replay recorded -o recorded/frames.mkv -y
"$program" replay taken -o taken/own.y4m -q && "$program" replay taken -o taken/own.y4m -q -y ||
    fail "a video in a folder of stills is no input"

# the same bits with any number of threads; fused gives another picture
for threads in 1 2 3 7; do
    "$program" $walk -n 40 --threads $threads -o t$threads.y4m --stats t$threads.csv || fail "threads $threads"
    cmp -s t1.y4m t$threads.y4m || fail "$threads threads give another picture"
done
"$program" $walk -n 40 --fused --threads 1 -o f1.y4m
"$program" $walk -n 40 --fused --threads 5 -o f5.y4m
cmp -s f1.y4m f5.y4m || fail "fused: threads give another picture"
cmp -s t1.y4m f1.y4m && fail "fused and exact are the same picture, which 40 frames of a walk cannot be"

# dither: for videos, not for stills, not with a report
"$program" $walk -n 2 --dither on -o on.y4m -o on && "$program" $walk -n 2 --dither off -o off.y4m -o off &&
    "$program" $walk -n 2 -o video.y4m && "$program" $walk -n 2 -o still || fail "dither"
cmp -s on.y4m off.y4m && fail "--dither on changes nothing"
cmp -s on.y4m video.y4m || fail "a video is not dithered"
cmp -s off/frame_000001.png still/frame_000001.png || fail "a still is dithered"
cmp -s on/frame_000001.png still/frame_000001.png && fail "--dither on does not reach stills"
expect 2 "a report measures codes" $walk -n 2 --dither on --report measured

# options reach the picture
for option in "--ev 1" "--key 0.3" "--white none" "--white 2" "--metering spot" "--roi 0,0,0.3,0.3" "--trim 5,95" "--meter-rows 8" "--formula 2" \
    "--formula 1 --weight 0.5" "--tau-light 0 --tau-dark 0" "--transfer linear" "--lock" \
    "--eye 100" "--eye 0.01"; do
    # shellcheck disable=SC2086
    "$program" $walk -n 40 $option -o o.y4m -y || fail "$option"
    cmp -s t1.y4m o.y4m && fail "$option changes nothing"
done

# each frame by itself, of a video too: settled at once, regardless of how the light changes
"$program" $walk -n 100 -o video.mkv
"$program" replay video.mkv -q --reset-each --stats each.csv || fail "--reset-each"
[ "$(grep -c settled each.csv)" = 100 ] || fail "--reset-each of a video: only $(grep -c settled each.csv) of 100 settled"

# a settled picture has the aimed level for any key, up to rounding to codes and the gamut
for option in "" "--ev -2" "--key 0.4" "--white none" "--trim 10,90"; do
    # shellcheck disable=SC2086
    "$program" replay synth:room --size 128x72 -q -n 30 $option --stats aimed.csv -y || fail "aimed: $option"
    awk -F, -v option="$option" '
        NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next }
        { off = log($at["output_level"] / $at["aimed_level"]) / log(2); most = off * off > most * most ? off : most }
        END { printf "synth:room %s: the display level is %+.4f stop from the one aimed at\n", option, most; exit !(NR == 31 && most * most < 0.03 ^ 2) }
    ' aimed.csv || fail "aimed: $option"
done

# a pixel without metering weight: the level is held, and time passes
printf 'PF\n1 1\n-1.0\n\0\0\0\77\0\0\0\77\0\0\0\77' >dot.pfm
"$program" replay dot.pfm -q --roi 0,0,0.1,0.1 --hold 2 --stats dot.csv || fail "a frame without weight"
[ "$(cut -d, -f4,24 dot.csv | tr -d '\r' | tr '\n' ' ')" = "dt_s,state 0,empty 0.033333333,empty " ] ||
    fail "a frame without weight: $(cut -d, -f4,24 dot.csv)"

# a report has only what was compared: no log-average if the metering has weights
"$program" $walk -n 2 --report even && "$program" $walk -n 2 --report spot --metering spot || fail "reports"
grep -q "long double" even/index.html || fail "a report without its figure of the log-average"
grep -q "long double" spot/index.html && fail "a report of a log-average that was not compared"

# damaged frames
"$program" $walk -n 3 -o stills
mkdir mixed && cp stills/frame_000000.png mixed/1.png && head -c 100 stills/frame_000001.png >mixed/2.png &&
    cp stills/frame_000002.png mixed/3.png
expect 1 "mixed/2.png" replay mixed -o m.y4m
absent m.y4m
expect 3 "mixed/2.png" replay mixed -o m.y4m --keep-going --stats m.jsonl
[ "$(wc -l <m.jsonl)" = 2 ] || fail "--keep-going: $(wc -l <m.jsonl) frames, expected 2"

# a full disk, simulated: no file above 8 KiB
for kind in mp4 y4m; do
    (ulimit -f 16 && trap '' XFSZ && "$program" $walk --size 320x180 -n 30 -o full.$kind 2>said.err)
    [ $? = 1 ] || fail "a full disk ends with exit $? for $kind"
    grep -q "full.$kind" said.err || fail "a full disk: $(cat said.err)"
    absent full.$kind
done

# Ctrl-C: the frames so far are kept, as many in each output
"$program" $walk --size 640x360 --hold 100 -o c.mp4 -o c.y4m -o cfolder --stats c.csv --report creport 2>said.err &
running=$!
until_true "no third picture" eval 'ls .cfolder.*/frame_000002.png >said.out 2>&1'
kill -INT $running
wait $running
[ $? = 130 ] || fail "Ctrl-C ends with exit $?"
kept=$(find cfolder -name 'frame_*.png' | wc -l)
grep -q "interrupted; $kept of [0-9]* frames are written; c.mp4; c.y4m; cfolder; c.csv$" said.err || fail "Ctrl-C: $(cat said.err), $kept are kept"
[ "$kept" -gt 0 ] && [ "$(wc -l <c.csv)" = $((kept + 1)) ] || fail "Ctrl-C: $kept pictures and $(wc -l <c.csv) lines"
for video in c.mp4 c.y4m; do
    "$program" replay $video -q --stats ckept.csv -y && [ "$(wc -l <ckept.csv)" = $((kept + 1)) ] || fail "Ctrl-C: another number of frames in $video"
done
absent creport
rm -rf c.mp4 c.y4m cfolder

# twice: nothing is left, except outputs that were already complete
mkdir twice
"$program" $walk --size 640x360 --hold 100 -o twice/c.mp4 2>said.err &
running=$!
until_true "no pending file" eval 'ls twice/.c.mp4.*.part >said.out 2>&1'
kill -STOP $running
kill -INT $running
kill -TERM $running
kill -CONT $running
wait $running
[ $? = 130 ] || fail "Ctrl-C twice ends with exit $?"
grep -q interrupted said.err || fail "Ctrl-C twice: $(cat said.err)"
absent

# the same while the other end of a pipe is open but idle
mkfifo pipe
sleep 60 <>pipe &
sleeper=$!
since=$(date +%s)
"$program" $walk --size 640x360 -o - -o cfolder >pipe 2>said.err &
running=$!
sleep 1
kill -TERM $running
wait $running
[ $? = 130 ] || fail "a stalled reader: exit $?"
grep -q "interrupted; no output is complete" said.err || fail "a stalled reader: $(cat said.err)"
absent cfolder
"$program" replay - -o c.mp4 <pipe >said.out 2>said.err &
running=$!
sleep 1
kill -TERM $running
wait $running
[ $? = 130 ] || fail "a stalled writer: exit $?"
kill $sleeper
[ $(($(date +%s) - since)) -lt 30 ] || fail "a stalled pipe: $(($(date +%s) - since)) seconds to end"

# Ctrl-C while gnuplot draws: no plot, but the video
mkdir bin
printf '#!/bin/sh\n[ "$(wc -l)" = 0 ] && exit\necho x >drawing\nsleep 3\nexit 1\n' >bin/gnuplot
chmod +x bin/gnuplot
PATH="$PWD/bin:$PATH" "$program" $walk -n 3 -o c.mp4 --plot c.svg 2>said.err &
running=$!
while [ ! -s drawing ] && kill -0 $running 2>said.out; do sleep 0.1; done
kill -INT $running
wait $running
[ $? = 130 ] || fail "Ctrl-C while gnuplot draws: exit $?"
grep -q "interrupted; 3 of 3 frames are written; c.mp4$" said.err || fail "Ctrl-C while gnuplot draws: $(cat said.err)"
[ -s c.mp4 ] || fail "Ctrl-C while gnuplot draws: no video"
absent c.svg

# nohup
(trap '' HUP && exec "$program" $walk --hold 10 -o hup.y4m) &
running=$!
sleep 0.5
kill -HUP $running
wait $running
[ $? = 0 ] || fail "nohup: exit $?"
[ -s hup.y4m ] || fail "nohup: no output"
rm -f hup.y4m

# with a closed standard error no sentence goes into an output
"$program" replay mixed -o m.y4m --keep-going -y 2>said.err
"$program" replay mixed -o m2.y4m --keep-going 2>&-
cmp -s m.y4m m2.y4m || fail "a closed standard error ends up in an output"

# a closed pipe
"$program" $walk --size 320x180 -o - 2>said.err | head -c 1000 >/dev/null
[ "$(wc -l <said.err)" = 1 ] || fail "a closed pipe: $(cat said.err)"

end_test
