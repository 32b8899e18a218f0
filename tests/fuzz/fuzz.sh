#!/bin/sh
# fuzz.sh PROGRAM SECONDS: runs a libFuzzer program, with the words of its format (tests/fuzz/words). It begins with
# tests/fuzz/seeds/NAME if that folder exists, with the inputs kept by earlier runs of the same build, and with the
# shared folder's files if it exists ($PUPIL_SHARED, else ../shared next to the checkout). An input that takes over 10 s
# or 2 GB counts as a finding.
set -eu
program=$1 seconds=$2
name=$(basename "$program")
corpus=$(dirname "$program")/corpus/$name
mkdir -p "$corpus"
set -- "$corpus"
seeds=$(dirname "$0")/seeds/$name
[ -d "$seeds" ] && set -- "$@" "$seeds"
shared=${PUPIL_SHARED:-$(dirname "$0")/../../../shared}/malformed
case $name in
fuzz_exr) folders="exr valid_but_unusual/exr" ;;
fuzz_radiance) folders="hdr valid_but_unusual/hdr" ;;
fuzz_pfm) folders="pnm_pfm valid_but_unusual/pfm" ;;
fuzz_png) folders="png valid_but_unusual/png16" ;;
*) folders= ;;
esac
# Texts of this kind from the tree itself.
tree=$(dirname "$0")/../..
case $name in
fuzz_recipe) set -- "$@" "$tree/fixtures/scenes" "$tree/tests/scene" ;;
fuzz_mesh) set -- "$@" "$tree/tests/scene" ;;
esac
for folder in $folders; do
    [ -d "$shared/$folder" ] && set -- "$@" "$shared/$folder"
done
case $name in
fuzz_raw_*) words=raw ;;
fuzz_recording*) words=recording ;;
fuzz_picture_file) words=jpeg ;;
fuzz_api | fuzz_coding | fuzz_v4l2) words=numbers ;;
*) words=${name#fuzz_} ;;
esac
exec "$program" -dict="$(dirname "$0")/words/$words.dict" -max_total_time="$seconds" -timeout=10 -rss_limit_mb=2048 -max_len=65536 -print_final_stats=1 \
    -verbosity=0 -artifact_prefix="$corpus/../" "$@"
