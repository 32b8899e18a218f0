#!/bin/sh
# camera.sh BUILD: docs/camera.md is right: each option of its commands exists, commands of `pupil run` that need no
# window and no other node work on a camera in the process, and the program prints the sentences that it quotes.
set -u
build=$(cd "$1" && pwd)
page=$(cd "$(dirname "$0")/../.." && pwd)/docs/camera.md
[ -x "$build/tests/run_fake" ] || { echo "skipped: built without cameras"; exit 77; }
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
failures=0

fail() {
    echo "FAILED: $*"
    failures=$((failures + 1))
}

# Indented, without comments: what a user copies. The first option that does not exist is reported.
sed -n 's/^    \$ \(pupil .*\)/\1/p' "$page" | sed 's/ *#.*//' >commands
[ "$(wc -l <commands)" -ge 7 ] || fail "only $(wc -l <commands) commands in $page"
while read -r _ command options; do
    # shellcheck disable=SC2086 # words
    "$build/apps/pupil" $command $options --no-such-option >said.out 2>said.err </dev/null
    [ $? = 2 ] && grep -q -- "--no-such-option: no such option" said.err || fail "$command $options: $(cat said.err)"
    case "$command $options" in
    run*--view* | run*/dev/* | list* | replay* | record*) ;;
    *)
        [ "$command" = probe ] || command=
        # shellcheck disable=SC2086 # words
        "$build/tests/run_fake" fake:size=320x240 fake:format=YUYV $command $options >said.out 2>said.err </dev/null ||
            fail "on the fake: $command $options: $(cat said.err)"
        ;;
    esac
    echo "pupil $command $options"
done <commands

# Options and values in the last chapter's table.
for option in $(grep -oE '`--[a-z-]+' "$page" | tr -d '`' | sort -u); do
    "$build/apps/pupil" help run >help.txt
    "$build/apps/pupil" help replay >>help.txt
    "$build/apps/pupil" help probe >>help.txt
    grep -q -- "$option\b" help.txt || fail "$option is in no help"
done

# said WORDS ARGUMENTS...: the words are printed on the fake, and are in the page
said() {
    words=$1
    shift
    "$build/tests/run_fake" "$@" >said.out 2>said.err </dev/null
    grep -qF -- "$words" said.err || fail "run_fake $*: no '$words' in: $(cat said.err)"
    grep -qF -- "$words" "$page" || fail "'$words' is not in $page"
}
said "no camera is there: " fake:absent
said "this camera has neither EXPOSURE_ABSOLUTE nor EXPOSURE" fake:no-controls -n 3
said "no frame within 5 seconds" fake:stall=3 -n 9
said "the camera was unplugged" fake:unplug=3 -n 9
echo "$failures failures"
[ "$failures" = 0 ]
