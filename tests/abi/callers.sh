#!/bin/sh
# callers.sh COMPILER TODAY LATER LATER_HEADERS: caller.c compiled with other headers than the library's either runs, or
# is refused before anything is touched. TODAY is the present library, LATER one as a later version may be.
set -eu
compiler=$1 today=$2 later=$3 later_headers=$4
here=$(cd "$(dirname "$0")" && pwd)
headers=$here/../../lib/include
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
status=0

# build HEADERS LIBRARY OPTIONS...
build() {
    include=$1 library=$2
    shift 2
    "$compiler" -std=c11 -O0 -g -fsanitize=address "$@" -I"$include" "$here/caller.c" "$library" -o "$work/caller"
}

# expect WHAT OUTPUT ARGUMENTS...
expect() {
    what=$1 expected=$2
    shift 2
    if ! "$work/caller" "$@" >"$work/log" 2>&1; then
        echo "callers.sh: $what: caller $* failed:" && head -30 "$work/log"
        status=1
    elif [ "$(cat "$work/log")" != "$expected" ]; then
        echo "callers.sh: $what: caller $* says '$(cat "$work/log")', not '$expected'"
        status=1
    else
        echo "$what${*:+, }$*: $expected"
    fi
}

build "$headers" "$today"
expect "same headers" runs
expect "same headers" runs zero

build "$headers" "$later"
expect "an older program" runs
expect "an older program" runs zero

build "$later_headers" "$today" -DADDED_BYTES=8
expect "a newer program" runs
expect "a newer program" runs zero
while read -r struct refusal; do
    expect "a newer program" "$refusal" set "$struct"
done <<'REFUSED'
pupil_config refused -2 by pupil_config_check
pupil_sensor_config refused -2 by pupil_sensor_init
pupil_row_gain_config refused -2 by pupil_row_gain_init
pupil_veil_config refused -2 by pupil_veil_init
pupil_gles_config refused -2 by pupil_gles_init
pupil_coding refused -14 by pupil_coding_check
pupil_image_const refused -22 by pupil_process
pupil_image refused -22 by pupil_process
pupil_frame_info refused -22 by pupil_process
pupil_curve refused -22 by pupil_map_rows
pupil_stats refused -22 by pupil_meter_rows
REFUSED

# Without its last field a struct is shorter than in any version, or has padding there; pupil_stats is then that of 0.2.0.
# Outputs are filled in up to their size.
while read -r struct result; do
    rm -rf "$work/include"
    sh "$here/vary.sh" removed "$struct" "$work/include"
    build "$work/include" "$today"
    expect "without the last field of $struct" "$result"
done <<'SHORTER'
pupil_config runs
pupil_sensor_config refused -2 by pupil_sensor_init
pupil_row_gain_config refused -2 by pupil_row_gain_init
pupil_veil_config refused -2 by pupil_veil_init
pupil_gles_config runs
pupil_coding refused -14 by pupil_coding_check
pupil_image_const runs
pupil_image refused -22 by pupil_process
pupil_frame_info refused -22 by pupil_process
pupil_curve refused -22 by pupil_map_rows
pupil_stats runs
pupil_exposure runs
pupil_sensor_setting runs
pupil_row_gain_result runs
pupil_veil_result runs
SHORTER
exit $status
