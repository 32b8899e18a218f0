# lib.sh: shared by the shell tests of the program. A test sources it, and from then on works in its own folder, which
# is removed at the end. A failure is counted and the test continues; the last line of a test is end_test. Processes
# that a test leaves in the background are killed with it if their ids are in $running.
room=$(mktemp -d) || exit 1
running=
failures=0

leave() {
    # shellcheck disable=SC2086 # ids
    [ -z "$running" ] || kill -9 $running 2>/dev/null
    rm -rf "$room"
}
trap leave EXIT
trap 'exit 1' INT TERM
cd "$room" || exit 1
export XDG_STATE_HOME=/dev/null # no run reads another one's state, or keeps its own

# fail SENTENCE
fail() {
    echo "FAILED: $*"
    failures=$((failures + 1))
}

end_test() {
    [ "$failures" = 0 ] || { echo "$failures failed"; exit 1; }
    echo "all as expected"
    exit 0
}

# skip REASON: something is not installed
skip() {
    [ "$failures" = 0 ] || end_test
    echo "skipped: $*"
    exit 77
}
# cannot REASON: this machine or this checkout cannot have what the test needs
cannot() {
    [ "$failures" = 0 ] || end_test
    echo "skipped: $*"
    exit 76
}

# needs TOOL...
needs() {
    for tool in "$@"; do
        command -v "$tool" >/dev/null || skip "no $tool: the packages are listed in test.sh"
    done
}

# The program under test: pupil itself, or pupil with a camera in the process (tests/apps/run_fake.c).
use_pupil() { program=${PUPIL_PROGRAM:?the pupil program}; }
use_fake_camera() {
    program=${PUPIL_RUN_FAKE:-}
    [ -n "$program" ] || skip "built without cameras"
}
# What run_fake prints at its end if the camera's controls are as their user had them.
fake_restored="fake: auto 3, exposure 77, gain 40"

# call STATUS WORDS ARGUMENTS...: the program's exit status, and words that its standard error holds. Its output is kept
# in said.out and said.err.
call() {
    status=$1 words=$2
    shift 2
    got=0
    "$program" "$@" >said.out 2>said.err </dev/null || got=$?
    [ "$got" = "$status" ] || fail "pupil $*: exit $got, expected $status: $(cat said.err)"
    [ -z "$words" ] || grep -qF -- "$words" said.err || fail "pupil $*: no '$words' in: $(cat said.err)"
}

# sentences: how many lines said.err has, without those of run_fake itself
sentences() { grep -cv '^fake: ' said.err || :; }

# expect STATUS WORDS ARGUMENTS...: call, and at most one sentence; where frames failed (3), one for each
expect() {
    call "$@"
    [ "$(sentences)" -le 1 ] || [ "$status" = 3 ] || fail "$*: more than one sentence: $(cat said.err)"
}

# absent PATH...: none of these exists, and nothing unfinished is anywhere in the folder
absent() {
    for path in "$@"; do
        [ ! -e "$path" ] || fail "$path is there"
    done
    left=$(find . -name '.*.part*' | head -n 3)
    [ -z "$left" ] || fail "left behind: $left"
}

# ends STATUS: the program in the background ($running) ends with STATUS within 30 seconds
ends() {
    tries=0
    while kill -0 "$running" 2>/dev/null && [ $tries -lt 300 ]; do
        sleep 0.1
        tries=$((tries + 1))
    done
    kill -9 "$running" 2>/dev/null && fail "it does not end"
    got=0
    wait "$running" || got=$?
    running=
    [ "$got" = "$1" ] || fail "exit $got, expected $1: $(cat said.err)"
}

# until_true WORDS COMMAND...: the command is true within twenty seconds; a slow machine draws when it can
until_true() {
    words=$1
    shift
    tries=0
    while ! "$@"; do
        tries=$((tries + 1))
        [ $tries -lt 100 ] || { fail "$words: $(cat said.err)"; return 1; }
        sleep 0.2
    done
}

# handles_signals: the program in the background has installed its handler for SIGINT. A shell makes its background jobs
# ignore that signal, so until then it is lost. (Before exec the job is a shell, which handles it, too.)
handles_signals() {
    [ "$(readlink "/proc/$running/exe")" != "$(readlink /proc/$$/exe)" ] &&
        [ $((0x0$(sed -n 's/^SigCgt:[^0-9a-f]*//p' "/proc/$running/status") & 2)) != 0 ]
}

# help_fits LINES COLUMNS FILE: the help text in FILE is not longer and not wider
help_fits() {
    [ "$(wc -l <"$3")" -le "$1" ] || fail "$3 has $(wc -l <"$3") lines"
    awk -v most="$2" 'length > most { exit 1 }' "$3" || fail "$3 has a line over $2 characters"
}
