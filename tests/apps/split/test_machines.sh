#!/bin/sh
# docs/examples/machines with GNU parallel and Snakemake: 12 clips and a long one, with workers that are killed in the
# middle, and a whole run that is killed and restarted: the same pictures and levels as one pupil replay each. Needs
# $PUPIL_PROGRAM.
examples=$(cd "$(dirname "$0")/../../../docs/examples/machines" && pwd)
. "$(dirname "$0")/../../lib.sh"
use_pupil
needs ffmpeg parallel snakemake

# Every third call is killed after a moment, but no work twice, because retries are limited.
cat >flaky <<END
#!/bin/sh
calls=\$((\$(cat "$room/calls" 2>/dev/null || echo 0) + 1))
echo \$calls >"$room/calls"
[ "\$1" != adapt ] && [ \$((calls % 3)) = 0 ] && mkdir "$room/\$(echo "\$*" | md5sum | cut -c 1-32)" 2>/dev/null ||
    exec "$program" "\$@"
"$program" "\$@" &
sleep 0.02
kill -9 \$! && echo killed >>"$room/kills"
wait \$!
END
chmod +x flaky

clip() { # NAME SECONDS
    ffmpeg -loglevel error -f lavfi -i "testsrc2=size=96x54:rate=30:duration=$2,hue=s=0.2,
        eq=contrast=0.6:brightness='if(lt(mod(t+$3,2),1),0.2,0.02)':eval=frame" -pix_fmt yuv420p -c:v ffv1 "$1"
    call 0 "" replay "$1" -o "$1.y4m" -q
}
frames() {
    for one in "$@"; do
        tail -n +2 "$one"
    done | sha256sum
}
same() { # NAME PARTS...
    name=$1
    shift
    [ "$(frames "$@")" = "$(frames "$name.y4m")" ] || fail "$name: other pictures"
}

export KIND=y4m PUPIL="$room/flaky"
i=0
while [ $i -lt 12 ]; do
    clip clip$i.mkv 1 0.$i
    sh "$examples/parallel.sh" clip$i.mkv 30 4 shown$i.nut >said 2>&1 || fail "clip $i: $(tail -n 3 said)"
    same clip$i.mkv shown$i.nut.parts/*.y4m
    [ -s shown$i.nut ] || fail "clip $i: no video"
    i=$((i + 1))
done
[ -s kills ] || fail "no worker was killed"

# Names are never run as commands. A folder belongs to one input and its settings. No range is without frames.
export PUPIL="$program"
for name in "x'; touch PWNED; '" "it's {1} \$(touch PWNED)" -dash; do
    cp clip0.mkv "./$name.mkv"
    sh "$examples/parallel.sh" "$name.mkv" 30 2 "$name.nut" >said 2>&1 || fail "$name: $(tail -n 3 said)"
    [ "$(frames "./$name.nut.parts/"*.y4m)" = "$(frames clip0.mkv.y4m)" ] || fail "$name: other pictures"
done
[ ! -e PWNED ] || fail "a name was run as a command"
refused() { # WORDS ARGUMENTS...
    words=$1
    shift
    sh "$examples/parallel.sh" "$@" >said 2>&1 && fail "$*: not refused"
    grep -qF -- "$words" said || fail "$*: no '$words' in $(tail -n 3 said)"
}
refused "usage: sh parallel.sh INPUT FRAMES RANGES" clip2.mkv 30
refused "shown0.nut.parts is of another" clip0.mkv 30 3 shown0.nut
refused "shown0.nut.parts is of another" clip0.mkv 31 4 shown0.nut
refused "shown0.nut.parts is of another" clip1.mkv 30 4 shown0.nut
OPTIONS="--ev -1" refused "shown1.nut.parts is of another" clip1.mkv 30 4 shown1.nut
touch clip1.mkv
refused "shown1.nut.parts is of another" clip1.mkv 30 4 shown1.nut
refused FRAMES clip0.mkv 3x 4 bad.nut
refused RANGES clip0.mkv 30 0 bad.nut
sh "$examples/parallel.sh" clip2.mkv 30 45 many.nut >said 2>&1 || fail "more ranges than frames: $(tail -n 3 said)"
same clip2.mkv many.nut.parts/*.y4m
PUPIL="$room/flaky"

clip long.mkv 40 0
timeout -s KILL 4 sh "$examples/parallel.sh" long.mkv 1200 64 shown.nut >said 2>&1
made=$(find shown.nut.parts -name '*.part' | wc -l)
sh "$examples/parallel.sh" long.mkv 1200 64 shown.nut >said 2>&1 || fail "long: $(tail -n 3 said)"
same long.mkv shown.nut.parts/*.y4m
echo "12 clips and a long one; $(wc -l <kills) workers killed, and a run after $made of 64 parts"

snakemake -q -s "$examples/Snakefile" -j 2 --config input=long.mkv frames=1200 ranges=7 out=snake.nut kind=y4m \
    "pupil=$program" >said 2>&1 || fail "snakemake: $(tail -n 5 said)"
same long.mkv snake.nut.parts/*.y4m
call 0 "" replay long.mkv -o long.mkv.y4m -q -y --ev -1
snakemake -q -s "$examples/Snakefile" -j 2 --config input=long.mkv frames=1200 ranges=3 out=snake.nut kind=y4m \
    "options=--ev -1" "pupil=$program" >said 2>&1 || fail "snakemake again: $(tail -n 5 said)"
same long.mkv snake.nut.parts/[0-2].y4m
end_test
