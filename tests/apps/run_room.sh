# run_room.sh: sourced by tests of the program on a camera in the process ($PUPIL_RUN_FAKE, tests/apps/run_fake.c):
# $program, a folder of its own that is the present one, fail SENTENCE, $failures; and nothing left: what runs in the
# background has its process in $running.
program=${PUPIL_RUN_FAKE:-}
[ -n "$program" ] || { echo "skipped: built without cameras"; exit 77; }
room=$(mktemp -d) || exit 1
running=
cleanup() {
    [ -z "$running" ] || kill -9 "$running" 2>/dev/null
    rm -rf "$room"
}
trap cleanup EXIT
cd "$room" || exit 1
failures=0

fail() {
    echo "FAILED: $*"
    failures=$((failures + 1))
}
