#!/bin/sh
# The same picture as PNG, JPEG, TIFF, BMP and video of several depths has the same level: with black parts, which count
# for the level of codes, and without; dark, where noise is not brightened; and a dim one, whose unit is not guessed.
# Needs ffmpeg.
set -u
. "$(dirname "$0")/../../lib.sh"
use_pupil
needs ffmpeg python3

scene="gradients=s=128x96:n=3:seed=7:c0=0x303840:c1=0x808078:c2=0xd0c8b0"
# pictures NAME FILTER...: the scene through the filter, in each format
pictures() {
    name=$1
    ffmpeg -v error -nostdin -f lavfi -i "$scene" -frames:v 1 -vf "$2,format=rgb24" "$name.png" || skip "no gradients"
    rgb="-v error -nostdin -i $name.png"
    # shellcheck disable=SC2086 # words
    ffmpeg $rgb -pix_fmt rgb48be "$name-16.png" && ffmpeg $rgb -pix_fmt rgb24 "$name.tif" &&
        ffmpeg $rgb -pix_fmt rgb48le "$name-16.tif" && ffmpeg $rgb "$name.bmp" &&
        ffmpeg $rgb -pix_fmt yuvj444p -q:v 1 -qmin 1 "$name.jpg" && ffmpeg $rgb -c:v ffv1 -pix_fmt gbrp "$name.mkv" &&
        ffmpeg $rgb -vf scale=out_color_matrix=bt709:out_range=tv -colorspace bt709 -color_range tv -c:v ffv1 \
            -pix_fmt yuv444p10le "$name-10.mkv" || fail "$name: ffmpeg"
    python3 - "$name.png" "$name-gamma.png" "$name-p3.png" <<'END'
import struct, sys, zlib
def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
def fixed(*numbers):
    return b"".join(struct.pack(">i", round(n * 65536)) for n in numbers)
png = open(sys.argv[1], "rb").read()
open(sys.argv[2], "wb").write(png[:33] + chunk(b"gAMA", struct.pack(">I", 45455)) + png[33:])
# The chromaticities of Rec.709, but blue: not sRGB, and hardly another luminance.
data = [b"XYZ \0\0\0\0" + fixed(*xyz) for xyz in ((0.43607, 0.22249, 0.01392), (0.38515, 0.71687, 0.09708),
                                                  (0.15307, 0.06061, 0.71410 - 0.01))]
data += 3 * [b"para\0\0\0\0\0\3\0\0" + fixed(2.4, 1 / 1.055, 0.055 / 1.055, 1 / 12.92, 0.04045)]
table, at = b"", 132 + 12 * 6
for name, one in zip((b"rXYZ", b"gXYZ", b"bXYZ", b"rTRC", b"gTRC", b"bTRC"), data):
    table += name + struct.pack(">II", at, len(one))
    at += len(one)
body = b"mntrRGB XYZ " + bytes(12) + b"acsp" + bytes(88) + struct.pack(">I", 6) + table + b"".join(data)
profile = struct.pack(">I", len(body) + 12) + bytes(8) + body
open(sys.argv[3], "wb").write(png[:33] + chunk(b"iCCP", b"p\0\0" + zlib.compress(profile)) + png[33:])
END
}

# alike NAME EV ARGUMENTS...: each format's level is that of the 8-bit PNG, within EV, and for the same reason
alike() {
    name=$1 most=$2
    shift 2
    rm -rf levels
    mkdir levels
    for file in "$name".* "$name"-*; do
        call 0 "" replay "$file" -n 1 --stats "levels/$file.jsonl" -q "$@"
    done
    python3 - "$most" "$name.png" levels/* <<'END' || fail "$name $*"
import json, sys
most, first = float(sys.argv[1]), sys.argv[2]
got = {name[7:-6]: json.loads(open(name).readline()) for name in sys.argv[3:]}
print(f"{first}: {got[first]['adapted_ev']:.2f} EV {got[first]['reason']}")
wrong = [f"{name}: {one['adapted_ev']:.2f} {one['reason']}" for name, one in got.items()
         if abs(one["adapted_ev"] - got[first]["adapted_ev"]) > most or one["reason"] != got[first]["reason"]]
print(*wrong, sep="\n")
sys.exit(len(got) < 10 or bool(wrong))
END
}

pictures whole null
alike whole 0.08 # a power law of 2.2 is not sRGB's curve
pictures bars pad=128:128:0:-1
alike bars 0.08
pictures object "scale=32:24,pad=128:96:-1:-1"
alike object 0.001
alike object 0.05 --amplification 32
pictures dark "lutrgb=r=val/16:g=val/16:b=val/16"
alike dark 0.001
end_test
