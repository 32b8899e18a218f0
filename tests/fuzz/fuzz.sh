#!/bin/sh
# fuzz.sh PROGRAM SECONDS: runs a libFuzzer program. It begins with tests/fuzz/seeds/NAME where that folder is, and with
# what earlier runs of the same build kept. An input that takes over 10 s or 2 GB counts as a finding.
set -eu
program=$1 seconds=$2
name=$(basename "$program")
corpus=$(dirname "$program")/corpus/$name
mkdir -p "$corpus"
set -- "$corpus"
seeds=$(dirname "$0")/seeds/$name
[ -d "$seeds" ] && set -- "$@" "$seeds"
exec "$program" -max_total_time="$seconds" -timeout=10 -rss_limit_mb=2048 -max_len=65536 -print_final_stats=1 \
    -verbosity=0 -artifact_prefix="$corpus/../" "$@"
