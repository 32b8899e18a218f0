#!/bin/sh
# `pupil help`, the names of commands, and a standard output that cannot be written.
set -eu
program=${PUPIL_PROGRAM:?}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# ends STATUS WORDS ARGUMENTS...: with this status, and these words on either output
ends() {
    expected=$1 words=$2
    shift 2
    status=0
    "$program" "$@" >"$work/said" 2>&1 || status=$?
    [ "$status" = "$expected" ] || { echo "FAILED: pupil $*: exit $status"; exit 1; }
    grep -qF -- "$words" "$work/said" || { echo "FAILED: pupil $*: $(cat "$work/said")"; exit 1; }
}
ends 2 "usage: pupil COMMAND"
ends 0 "usage: pupil COMMAND" help
ends 0 "usage: pupil COMMAND" help version
ends 0 "usage: pupil replay" help replay
ends 0 "usage: pupil replay" --help replay
ends 2 "repaly: no such command; perhaps replay; 'pupil help' lists them" repaly
ends 2 "hepl: no such command; perhaps help;" hepl
ends 2 "moon: no such command; 'pupil help' lists them" moon
ends 2 "pupil replay $0 -o OUT adapts a file" "$0"
ends 2 "moon: no such command" help moon
ends 2 "replay moon: no such command" help replay moon
ends 2 "no such command" help "$(head -c 300 /dev/zero | tr '\0' x)"
if "$program" bench --help | grep -q usage; then
    ends 0 "usage: pupil bench kernels" help bench kernels
fi

for arguments in --version help "help replay" "help --man" "completion bash" "replay --help" "bench --help"; do
    status=0
    "$program" $arguments >/dev/full 2>"$work/said" || status=$?
    [ "$status" = 1 ] && [ -s "$work/said" ] || { echo "FAILED: pupil $arguments >/dev/full: exit $status"; exit 1; }
    status=0
    "$program" $arguments >&- 2>"$work/said" || status=$?
    [ "$status" = 1 ] && [ -s "$work/said" ] || { echo "FAILED: pupil $arguments >&-: exit $status"; exit 1; }
done
