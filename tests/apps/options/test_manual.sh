#!/bin/sh
# docs/pupil.1 is the output of `pupil help --man >docs/pupil.1`, and a formatter reads it without a warning.
set -eu
program=${PUPIL_PROGRAM:?}
page=$(dirname "$0")/../../../docs/pupil.1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

"$program" help --man >"$work/pupil.1"
if "$program" bench gles --help | grep -q usage; then # a build with everything
    diff "$page" "$work/pupil.1" || { echo "FAILED: make it again: $program help --man >docs/pupil.1"; exit 1; }
fi
command -v groff >/dev/null || { echo "no groff: not formatted"; exit 0; }
groff -man -ww -Tascii -P-c -P-b -P-u "$work/pupil.1" >"$work/text" 2>"$work/said"
[ ! -s "$work/said" ] || { echo "FAILED: $(cat "$work/said")"; exit 1; }
grep -q "no-frame-rate-priority" "$work/text" || { echo "FAILED: an option is lost"; exit 1; }
