#!/bin/sh
# What `pupil completion bash` prints, in a bash without other completions: commands, options, the words of a choice.
set -eu
program=${PUPIL_PROGRAM:?}
command -v bash >/dev/null || { echo "skipped: no bash"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
PATH=$(dirname "$program"):$PATH
"$program" completion bash >"$work/pupil"
bash -n "$work/pupil"
"$program" completion fish >/dev/null 2>"$work/said" && { echo "FAILED: fish"; exit 1; }
grep -q "bash" "$work/said"

# completes EXPECTED WORD...: the last word is the one to complete
completes() {
    expected=$1
    shift
    got=$(bash -c '
        set -u
        . "$1"
        shift
        COMP_WORDS=("$@")
        COMP_CWORD=$(($# - 1))
        _pupil
        echo "${COMPREPLY[*]-}"' bash "$work/pupil" "$@")
    [ "$got" = "$expected" ] || { echo "FAILED: $*: '$got', expected '$expected'"; exit 1; }
}
completes "replay" pupil repl
completes "bench" pupil be
completes "version" pupil v
completes "record" pupil help rec
completes "bash" pupil completion ""
completes "--mode" pupil run --mo
completes "digital sensor both" pupil run --mode ""
completes "sensor" pupil run -d 0 --mode s
completes "linear" pupil replay --transfer = l
completes "srgb gamma22 linear" pupil replay --transfer =
completes "--hold" pupil replay a.exr --ho
completes "" pupil replay a.e
completes "" pupil run --ho
completes "kernels gles scene ae deferred veil" pupil bench ""
completes "--peers" pupil bench kernels --pe
completes "nv12" pupil bench kernels --out nv
completes "--readout" pupil run --mains 50 --rea
