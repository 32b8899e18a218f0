#!/bin/sh
# pupil replay --gles: the CPU's picture within the limits of gpu.md, the same bits in every run; what happens if the
# GPU is not available or lacks a feature. Needs an OpenGL ES driver; software is enough.
set -u
. "$(dirname "$0")/../../lib.sh"
use_pupil
walk="synth:walk --size 96x54 -n 24"
# near FILE FILE: equal sizes; no byte differs by more than 1, at most one of 10,000 differs
near() {
    [ "$(wc -c <"$1")" = "$(wc -c <"$2")" ] || { fail "$1 and $2 differ in size"; return; }
    cmp -l "$1" "$2" | awk -v all="$(wc -c <"$1")" '
        function code(octal) { return int(octal / 100) * 64 + int(octal / 10) % 10 * 8 + octal % 10 }
        { d = code($2) - code($3); if (d * d > 1) worse++; n++ }
        END { exit worse > 0 || n > all / 10000 }' || fail "$1 and $2: $(cmp -l "$1" "$2" | wc -l) bytes differ"
}
# close FILE FILE: metered and adapted EV of every frame, within 1e-5 (relative) of luminance: 1.45e-5 stops
close() {
    paste -d, "$1" "$2" | awk -F, 'NR == 1 { for (i = 1; i <= NF / 2; i++) if ($i ~ /^(metered|adapted)_ev/) at[i]; next }
        { for (i in at) { d = $i - $(i + NF / 2); if (d > 1.45e-5 || d < -1.45e-5) wrong++; n++ } }
        END { exit !(n > 0 && wrong == 0) }' || fail "$1 and $2: levels differ"
}
# warned WORDS: one sentence that says so, and that the CPU continues
warned() {
    [ "$(wc -l <said.err)" = 1 ] || fail "not one sentence: $(cat said.err)"
    grep -q "^pupil replay: --gles: .*; the CPU continues$" said.err || fail "no warning: $(cat said.err)"
    grep -qF -- "$1" said.err || fail "no '$1' in: $(cat said.err)"
}

# what is refused at once
for bad in "--gles-version 2.0" "--gles-version 3.1" "--loop"; do
    case $bad in
    *2.0) option="--gles $bad" ;;
    *) option=$bad ;;
    esac
    # shellcheck disable=SC2086 # words
    "$program" replay synth:walk $option >said.out 2>said.err
    [ $? = 2 ] || fail "$option is not refused"
    grep -qF -- "${bad%% *}" said.err || fail "$option: said $(cat said.err)"
done
"$program" replay - --view --loop </dev/null 2>said.err && fail "--loop of standard input"
grep -q "standard input cannot be read again" said.err || fail "--loop of standard input: $(cat said.err)"

# shellcheck disable=SC2086
"$program" replay $walk -o cpu.y4m --stats cpu.csv -q || fail "the CPU"
# shellcheck disable=SC2086
"$program" replay $walk --gles -o gpu.y4m --stats gpu.csv 2>said.err || fail "--gles: $(cat said.err)"
if grep -q "the CPU continues" said.err; then
    cmp -s cpu.y4m gpu.y4m || fail "without a GPU another picture"
    skip "$(head -n 1 said.err)"
fi
grep -q "; GPU: .*OpenGL ES" said.err || fail "the GPU is not named: $(cat said.err)"
near cpu.y4m gpu.y4m
close cpu.csv gpu.csv
# shellcheck disable=SC2086
"$program" replay $walk --gles -o again.y4m -q --threads 3
cmp -s gpu.y4m again.y4m || fail "another run, another picture"

# options reach the GPU, in both versions
for options in "--fused" "--white 3 --ev 1 --metering spot" "--trim 5,95" "--formula 1 --key 0.3" "--lock --transfer gamma22" "--eye 0.05" \
    "--reset-each" "--tone adjust" "--veil eye:70 --fov 90" "--white none --meter-rows 1 --gles-version 3.0" \
    "--white follow --tone equalise --meter-rows 1 --gles-version 3.0" \
    "--white 2 --fused --metering centre --meter-rows 1 --gles-version 3.0"; do # one row in four would be another level
    plain=${options%--gles-version*}
    # shellcheck disable=SC2086
    "$program" replay $walk $plain -o c.y4m --stats c.csv -q -y
    # shellcheck disable=SC2086
    "$program" replay $walk $options --gles -y -o g.y4m --stats g.csv 2>said.err || fail "$options: $(cat said.err)"
    grep -q "; GPU: .*OpenGL ES" said.err || fail "$options: not on the GPU: $(cat said.err)"
    case $options in
    *3.0*) grep -q "as in ES 3.0" said.err || fail "$options: another version: $(cat said.err)" ;;
    esac
    near c.y4m g.y4m
    close c.csv g.csv
done

# sizes and formats that change during the run
mkdir many
"$program" replay synth:walk --size 32x20 -n 1 -q -o many/1.png
"$program" replay synth:walk --size 20x33 -n 1 -q -o many/2.png
printf 'PF\n3 2\n-1.0\n' >many/3.pfm
head -c 72 /dev/zero | sed 's/\x00\x00\x00\x00/\x00\x00\x80\x3f/g' >>many/3.pfm
"$program" replay many -q -y --stats c.csv && "$program" replay many --gles -y --stats g.csv 2>said.err || fail "many sizes"
grep -q "; GPU: " said.err && ! grep -q " of 3 frames" said.err || fail "many sizes: $(cat said.err)"
close c.csv g.csv

# a version without a histogram although the white point follows; no driver; too old a version: the CPU's own bits
for how in "needs; --white none" "EGL" "OpenGL ES"; do
    case $how in
    needs*)
        set -- env MESA_GLES_VERSION_OVERRIDE=3.0 \
            "MESA_EXTENSION_OVERRIDE=-GL_EXT_color_buffer_float -GL_EXT_color_buffer_half_float" \
            "$program" replay synth:walk --gles-version 3.0
        ;;
    EGL) set -- env __EGL_VENDOR_LIBRARY_FILENAMES=/nowhere EGL_PLATFORM=nothing "$program" replay synth:walk ;;
    *) set -- env MESA_GLES_VERSION_OVERRIDE=2.0 "$program" replay synth:walk ;;
    esac
    "$@" --size 96x54 -n 24 --gles -q -y -o other.y4m --stats other.csv 2>said.err || fail "$how: exit $?"
    [ -s said.err ] || { echo "$how: this driver cannot be made to lack it"; continue; }
    warned "$how"
    cmp -s cpu.y4m other.y4m || fail "$how: another picture than the CPU's"
done

end_test
