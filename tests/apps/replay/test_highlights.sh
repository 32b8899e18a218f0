#!/bin/sh
# synth:walk, past a window with the sun, at 24, 30, 60 and 240 frames a second: each step of the level is the law's
# share of the distance to the frame's target, highlights included, and the levels at 60 and 240 are those at 30. Needs
# $PUPIL_PROGRAM; runs in a folder of its own.
set -u
. "$(dirname "$0")/../../lib.sh"
use_pupil

# play FPS HOLD STOPS FILE
play() {
    "$program" replay synth:walk --size 64x36 --fps "$1" --hold "$2" --highlights "$3" --stats "$4" -q -y ||
        fail "$1 frames/s does not replay"
}

for rate in "24 1" "30 1" "60 2" "240 8"; do
    fps=${rate% *} hold=${rate#* }
    play "$fps" "$hold" 2 "$fps.csv"
    play "$fps" "$hold" 0 without.csv
    awk -F, -v fps="$fps" '
        FNR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; file++; next }
        {
            level = $at["adapted_ev"]; held = $at["held_back_ev"]; target = $at["metered_ev"] + held
            share = 1 - exp(-$at["dt_s"] / (target > before ? 0.3 : 0.9))
            step = level - before
            if (FNR > 2) {
                off = step - share * (target - before)
                wrong = off * off > wrong * wrong ? off : wrong
                most[file] = step * step > most[file] * most[file] ? step : most[file]
            }
            before = level
            stops[file] = held > stops[file] ? held : stops[file]
        }
        END {
            printf "synth:walk, %3d frames/s: largest step %+.4f EV, without highlights %+.4f; held up to %.2f EV; %.1e from the law\n",
                fps, most[1], most[2], stops[1], wrong
            exit wrong * wrong > 1e-16 || stops[1] != 2 || stops[2] != 0 || FNR < 301
        }' "$fps.csv" without.csv || fail "$fps frames/s: not the steps of the law"
done

# each frame of the walk when it is shown the last time: as much time has passed as at 30
for rate in "60 2" "240 8"; do
    fps=${rate% *} hold=${rate#* }
    awk -F, -v hold="$hold" -v fps="$fps" '
        FNR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next }
        NR == FNR { level[FNR - 2] = $at["adapted_ev"]; next }
        (FNR - 1) % hold == 0 { off = $at["adapted_ev"] - level[(FNR - 1) / hold - 1]; most = off * off > most * most ? off : most; n++ }
        END { printf "synth:walk, %d frames/s: %.1e EV from 30, in %d frames\n", fps, most, n; exit most * most > 1e-12 || n != 300 }
    ' 30.csv "$fps.csv" || fail "$fps frames/s: other levels than at 30"
done
end_test
