#!/bin/sh
# Every real HDR image, clip and panorama of the shared folder through `pupil replay`, and what the picture must be:
#   - the log-average, mapped by the frame's own curve, lies within a third of a stop of the key, in the mean over the frames
#     (Reinhard's curve itself takes log2(1.18) = 0.24 stop from a key of 0.18 where there is no white point);
#   - of the display's samples under 2 % are 0, and under 2 % are 255, beyond what the input holds as black or clipped.
# Needs $PUPIL_PROGRAM; $PUPIL_SHARED, or ../shared beside the checkout.
set -u
here=$(cd "$(dirname "$0")/../../.." && pwd)
shared=${PUPIL_SHARED:-$here/../shared}/hdr
. "$(dirname "$0")/../../lib.sh"
use_pupil
[ -d "$shared" ] || cannot "no shared images"

# judge NAME SKIP ARGUMENTS...: replays; frames before SKIP are not checked
judge() {
    name=$1 first=$2
    shift 2
    if ! "$program" replay "$@" -q --stats "$room/s.csv" -o "$room/frames" -y; then
        echo "FAILED: $name"
        failures=$((failures + 1))
        return
    fi
    awk -F, -v name="$name" -v first="$first" '
        NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next }
        $at["frame"] >= first {
            u = $at["scale"] * 2 ^ $at["metered_ev"]
            w = $at["white"]
            mapped = u * (1 + (w > 0 ? u / (w * w) : 0)) / (1 + u)
            off += log(mapped / $at["key"]) / log(2) # highlights make it darker
            level += log($at["output_level"] / $at["key"]) / log(2)
            black += $at["output_black_share"] - $at["black_share"] - $at["bad_share"]
            white += $at["output_white_share"] - $at["clipped_share"] - $at["bad_share"]
            n++
        }
        END {
            off /= n; level /= n; black *= 100 / n; white *= 100 / n
            bad = off > 1 / 3 || off < -1 / 3 || black >= 2 || white >= 2
            printf "%-28s %4d frames   mapped log-average %+.3f stop, display level %+.3f stop from the key   at 0 %.3f %%, at 255 %.3f %%%s\n",
                name, n, off, level, black, white, bad ? "   FAILED" : ""
            exit bad
        }' "$room/s.csv" || failures=$((failures + 1))
}

for image in "$shared"/*.exr "$shared"/*.hdr; do
    judge "$(basename "$image")" 0 "$image"
done
for panorama in adams_place_bridge_1k.hdr dikhololo_night_1k.hdr spruit_sunrise_4k.exr; do
    judge "pan:$panorama" 0 "pan:$shared/$panorama,duration=60" --size 160x90 --fps 4
done
mkdir "$room/roof" && tar -xf "$shared/roof_hdr10_640x360_28f.tar" -C "$room/roof" --strip-components=1
judge "roof_hdr10 (28 frames)" 0 "$room/roof"
exit $((failures > 0))
