#!/bin/sh
# Inputs that never end or never deliver: devices, pipes, sparse files of a terabyte. Each is refused, or ends at the
# first Ctrl-C, and leaves nothing.
set -u
. "$(dirname "$0")/../../lib.sh"
use_pupil
needs truncate mkfifo

"$program" record synth:walk recording --frames 2 --width 64 --height 64 2>said.err || fail "record: $(cat said.err)"

# hostile NAME: a recording in which this file is replaced by such an input
hostile() {
    rm -rf hostile
    cp -r recording hostile
    rm "hostile/$1"
}

# ends_by_one_signal ARGUMENTS...: ends by itself at once, or at the first signal
ends_by_one_signal() {
    "$program" "$@" >said.out 2>said.err </dev/null &
    running=$!
    tries=0
    while kill -0 $running 2>/dev/null && ! handles_signals && [ $tries -lt 100 ]; do
        sleep 0.05
        tries=$((tries + 1))
    done
    sleep 0.2
    kill -INT $running 2>/dev/null
    tries=0
    while kill -0 $running 2>/dev/null && [ $tries -lt 300 ]; do
        sleep 0.1
        tries=$((tries + 1))
    done
    kill -9 $running 2>/dev/null && fail "$*: does not end"
    got=0
    wait $running || got=$?
    running=
    case $got in
    1 | 2 | 130) [ "$(sentences)" = 1 ] || fail "$*: not one sentence: $(cat said.err)" ;;
    *) fail "$*: exit $got: $(cat said.err)" ;;
    esac
    absent out.y4m out.mp4
}

for name in frames.jsonl recording.json frames.mkv; do
    hostile $name
    ln -s /dev/zero hostile/$name
    ends_by_one_signal replay hostile -o out.y4m
    grep -q "$name" said.err || fail "$name is a device: $(cat said.err)"
    hostile $name
    mkfifo hostile/$name
    ends_by_one_signal replay hostile -o out.y4m
    grep -q "$name" said.err || fail "$name is a pipe: $(cat said.err)"
    hostile $name
    truncate -s 1T hostile/$name
    ends_by_one_signal replay hostile -o out.y4m
done

mkfifo pipe.exr pipe
for input in pipe.exr pipe /dev/zero; do
    ends_by_one_signal replay $input -o out.y4m
    ends_by_one_signal render $input -o out.mp4
done

# Valid first bytes make libav search for more: an AVI, JPEG and a transport stream.
printf 'RIFF\0\0\0\0AVI LIST' >big.avi
printf '\377\330\377\340' >big.mjpg
printf 'G@\0\020' >packet
truncate -s 188 packet
for _ in 1 2 3 4 5 6 7 8 9 10; do cat packet packet packet packet packet; done >big.ts
for input in big.avi big.mjpg big.ts; do
    truncate -s 1T $input || cannot "no sparse files here"
    ends_by_one_signal replay $input -o out.y4m
done
end_test
