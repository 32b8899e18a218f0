#!/bin/sh
# Stills of all kinds and sizes, from folders and from a pipe, by their names into a folder. Needs ffmpeg.
set -u
. "$(dirname "$0")/../../lib.sh"
use_pupil
needs ffmpeg ffprobe python3

sides() { ffprobe -v error -show_entries stream=width,height -of csv=p=0 "$1"; }
# likeness A B: PSNR in dB, an integer; 999 if they are the same
likeness() {
    ffmpeg -nostdin -i "$1" -i "$2" -lavfi "[0]format=rgb24[a];[1]format=rgb24[b];[a][b]psnr" -f null - 2>&1 |
        sed -n 's/.*average:\([0-9inf]*\).*/\1/p' | sed 's/inf/999/'
}

# twelve stills of four sizes
mkdir in
for size in 40x30 30x40 64x36 33x17; do
    for kind in png jpg tif; do
        ffmpeg -v error -nostdin -f lavfi -i "mandelbrot=s=$size" -frames:v 1 -q:v 1 "in/$kind-$size.$kind" || skip "ffmpeg writes no $kind"
    done
done
expect 0 "replayed 12 frames" replay in --reset-each -o out
[ "$(find out -type f | wc -l)" = 12 ] || fail "$(find out -type f | wc -l) pictures of 12"
for still in in/*; do
    name=${still##*/}
    [ "$(sides "out/${name%.*}.png")" = "$(sides "$still")" ] || fail "$name: $(sides "out/${name%.*}.png") pixels"
done
for size in 40x30 33x17; do # the same picture, in every format
    [ "$(likeness out/png-$size.png out/tif-$size.png)" -ge 45 ] || fail "$size: TIFF and PNG differ: $(likeness out/png-$size.png out/tif-$size.png) dB"
    [ "$(likeness out/png-$size.png out/jpg-$size.png)" -ge 25 ] || fail "$size: JPEG and PNG differ"
done

# a name that occurs twice, a folder with other files, and files that stay
mkdir twice && cp in/png-40x30.png twice/a.png && cp in/tif-30x40.tif twice/a.tif
expect 1 "out/jpg-30x40.png: is there already" replay in --reset-each -o out
echo mine >out/notes.txt
expect 0 "" replay in/* --reset-each -o out -y
expect 0 "" replay twice --reset-each -o out
[ "$(sides out/a.png) $(sides out/a-1.png)" = "40,30 30,40" ] || fail "two of one name: $(ls out)"
[ "$(cat out/notes.txt)" = mine ] && [ "$(find out -type f | wc -l)" = 15 ] || fail "a folder with other files: $(ls out)"
mkdir out/b.png && cp twice/a.png twice/b.png
expect 1 "out/b.png: is there already, and no file" replay twice --reset-each -o out -y
rmdir out/b.png
absent

# without --reset-each they are one sequence: of one size, by number
expect 1 "a folder takes stills of any, with --reset-each" replay in -o sequence
expect 0 "" replay in/png-40x30.png in/jpg-40x30.jpg -o sequence
[ -s sequence/frame_000001.png ] || fail "a sequence has other names: $(ls sequence)"
absent
expect 1 "; that frame is in/png-" replay in/png-* -o sequence.mp4
# NaN and infinite pixels are reported
python3 -c 'import struct, sys
nan, inf = float("nan"), float("inf")
rows = [[nan] * 3 * 8, [inf] * 3 * 8] + [[0.2] * 3 * 8] * 14
sys.stdout.buffer.write(b"PF\n8 16\n-1.0\n" + struct.pack("<384f", *sum(rows, [])))' >bad.pfm
expect 0 "1 frame has pixels that are NaN (shown black) or infinite, up to 12 % of one" replay bad.pfm -o bad.png

# a JPEG is written as it is displayed, without wrong tags
expect 0 "" replay in/png-64x36.png -o one.jpg
expect 0 "" replay in/png-64x36.png -o one.png
[ "$(likeness one.png one.jpg)" -ge 38 ] || fail "the JPEG is not the PNG: $(likeness one.png one.jpg) dB"
expect 0 "" replay in/png-64x36.png -o one.tif
[ "$(likeness one.png one.tif)" = 999 ] || fail "the TIFF is not the PNG: $(likeness one.png one.tif) dB"
expect 0 "" replay one.tif -o again.png
expect 0 "" replay one.png -o again2.png
[ "$(likeness again.png again2.png)" = 999 ] || fail "pupil reads its TIFF otherwise than its PNG"
expect 1 "one picture" replay in/png-64x36.png --hold 2 -o two.tiff
expect 1 "others by ffmpeg: pupil ... -q -o - | ffmpeg -i - none.gif" replay in/png-64x36.png -o none.gif
expect 2 "none.mp4: there is no such file; if it is the output: pupil replay in/png-64x36.png -o none.mp4" \
    replay in/png-64x36.png none.mp4
expect 1 "a TIFF is written as sRGB alone" replay in/png-64x36.png --transfer linear -o linear.tif
expect 1 "one picture" replay in/png-64x36.png --hold 2 -o two.jpeg
expect 1 "written as sRGB alone" replay in/png-64x36.png --transfer linear -o linear.jpg
absent two.jpeg two.tiff linear.jpg linear.tif

# a TIFF of floats, which libav does not support, is not reported as damaged
python3 - <<'END'
import struct
tags = [(256, 3, 8), (257, 3, 8), (258, 3, 32), (259, 3, 1), (262, 3, 1), (273, 4, 8), (277, 3, 1), (278, 3, 8),
        (279, 4, 256), (339, 3, 3)]
with open("float.tif", "wb") as f:
    f.write(b"II*\0" + struct.pack("<I64f", 264, *(0.1 * i for i in range(64))) + struct.pack("<H", len(tags)))
    f.write(b"".join(struct.pack("<HHII", tag, kind, 1, value) for tag, kind, value in tags) + bytes(4))
END
expect 1 "save it as OpenEXR (.exr) or PFM" replay float.tif -o float.png
absent float.png

# a JPEG and a PNG of grey with an ICC profile of linear light are by so much brighter
python3 - <<'END'
import struct, zlib
def tag(kind, *numbers):
    return kind + bytes(4) + b"".join(struct.pack(">i", round(n * 65536)) for n in numbers)
data = [tag(b"XYZ ", 0.43607, 0.22249, 0.01392), tag(b"XYZ ", 0.38515, 0.71687, 0.09708),
        tag(b"XYZ ", 0.14307, 0.06061, 0.71410)] + 3 * [b"curv" + bytes(8)]
names, at, table = (b"rXYZ", b"gXYZ", b"bXYZ", b"rTRC", b"gTRC", b"bTRC"), 132 + 12 * 6, b""
for name, one in zip(names, data):
    table += name + struct.pack(">II", at, len(one))
    at += len(one)
profile = b"mntrRGB XYZ " + bytes(12) + b"acsp" + bytes(88) + struct.pack(">I", 6) + table + b"".join(data)
profile = struct.pack(">I", len(profile) + 12) + bytes(8) + profile
open("icc", "wb").write(b"\xff\xe2" + struct.pack(">H", len(profile) + 16) + b"ICC_PROFILE\0\1\1" + profile)
def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
for name, profiles in ("grey.png", b""), ("linear.png", chunk(b"iCCP", b"linear\0\0" + zlib.compress(profile))):
    open(name, "wb").write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 16, 16, 8, 2, 0, 0, 0)) +
                           profiles + chunk(b"IDAT", zlib.compress(16 * (b"\0" + 48 * b"\x80"))) + chunk(b"IEND", b""))
END
ffmpeg -v error -nostdin -f lavfi -i "color=gray:s=16x16" -frames:v 1 -q:v 1 grey.jpg
python3 -c 'jpeg = open("grey.jpg", "rb").read()
open("linear.jpg", "wb").write(jpeg[:2] + open("icc", "rb").read() + jpeg[2:])'
metered() { sed 's/.*"metered_ev":\([^,]*\),.*/\1/' "$1"; }
for kind in jpg png; do
    expect 0 "" replay grey.$kind --stats grey.jsonl -y
    expect 0 "" replay linear.$kind --stats linear.jsonl -y
    python3 -c "import math
code = (2 ** $(metered grey.jsonl)) ** (1 / 2.4) * 1.055 - 0.055
exit(abs($(metered linear.jsonl) - math.log2(code)) > 0.01)" ||
        fail "$kind: grey at $(metered grey.jsonl) EV is at $(metered linear.jsonl) by a linear profile"
done

# a JPEG with a gain map is brighter by its stops; without the map, or with a damaged one, a message says why it is not
python3 - <<'END'
import struct
jpeg = open("grey.jpg", "rb").read()
def with_xmp(properties):
    xmp = b'http://ns.adobe.com/xap/1.0/\0<x xmlns:hdrgm="http://ns.adobe.com/hdr-gain-map/1.0/" ' + properties + b"/>"
    return jpeg[:2] + b"\xff\xe1" + struct.pack(">H", len(xmp) + 2) + xmp + jpeg[2:]
first = with_xmp(b'hdrgm:Version="1.0"')
stops = b'hdrgm:Version="1.0" hdrgm:GainMapMin="%s" hdrgm:GainMapMax="2" hdrgm:OffsetSDR="0" hdrgm:OffsetHDR="0"'
open("gain.jpg", "wb").write(first + with_xmp(stops % b"2"))
open("damaged.jpg", "wb").write(first + with_xmp(stops % b"two"))
open("left-out.jpg", "wb").write(first)
END
for kind in grey gain; do
    expect 0 "" replay $kind.jpg -q --stats $kind.jsonl -y
done
for kind in damaged left-out; do
    expect 0 "pupil replay: $kind.jpg: is read as SDR, without its gain map: i" replay $kind.jpg -q --stats $kind.jsonl -y
done
python3 -c "exit(abs($(metered gain.jsonl) - $(metered grey.jsonl) - 2) > 1e-4)" ||
    fail "with a gain of 2 stops $(metered gain.jsonl), not $(metered grey.jsonl) + 2"
for kind in damaged left-out; do
    [ "$(metered $kind.jsonl)" = "$(metered grey.jsonl)" ] || fail "$kind.jpg: $(metered $kind.jsonl)"
done
expect 0 "damaged.jpg: is read as SDR, without its gain map: its metadata have no GainMapMin" meter damaged.jpg -q --range 0..1 -o damaged.part

# what the data window of OpenEXR leaves of the picture is not metered: the level is that of --roi
ffmpeg -v error -nostdin -i in/png-64x36.png -pix_fmt gbrpf32le whole.exr || skip "ffmpeg writes no EXR"
python3 - <<'END'
import struct
exr = open("whole.exr", "rb").read()
at = exr.index(b"displayWindow\0box2i\0") + 24
open("part.exr", "wb").write(exr[:at] + struct.pack("<4i", -64, -36, 191, 107) + exr[at + 16:])
END
adapted() { sed 's/.*"adapted_ev":\([^,]*\),.*/\1/' "$1"; }
expect 0 "" replay whole.exr --stats whole.jsonl
expect 0 "" replay part.exr --stats part.jsonl
expect 0 "" replay part.exr --roi 0.25,0.25,0.25,0.25 --stats roi.jsonl
[ "$(adapted part.jsonl)" = "$(adapted roi.jsonl)" ] || fail "the level $(adapted part.jsonl), by --roi $(adapted roi.jsonl)"
python3 -c "exit(abs($(adapted part.jsonl) - $(adapted whole.jsonl)) > 0.001)" ||
    fail "the level $(adapted part.jsonl), without what is around it $(adapted whole.jsonl)"
expect 0 "" replay whole.exr part.exr whole.exr --reset-each --stats three.jsonl
[ "$(adapted three.jsonl | tr '\n' ' ')" = "$(adapted whole.jsonl) $(adapted part.jsonl) $(adapted whole.jsonl) " ] ||
    fail "of three: $(adapted three.jsonl)"

# all formats on standard input, as a file and as a pipe
ffmpeg -v error -nostdin -i in/png-40x30.png -pix_fmt gbrpf32le in/x.exr || skip "ffmpeg writes no EXR"
ffmpeg -v error -nostdin -f lavfi -i testsrc2=s=64x36:r=25:d=1 -c:v mpeg4 late.mp4 # its index comes last
for input in in/png-40x30.png in/tif-40x30.tif in/jpg-40x30.jpg in/x.exr late.mp4; do
    expect 0 "" replay "$input" -q -y -n 1 -o named.png
    "$program" replay - -q -n 1 -o redirected.png -y <"$input" 2>said.err || fail "<$input: $(cat said.err)"
    # shellcheck disable=SC2002 # a pipe is the subject
    cat "$input" | "$program" replay - -q -n 1 -o piped.png -y 2>said.err || fail "cat $input |: $(cat said.err)"
    cmp -s named.png redirected.png && cmp -s named.png piped.png || fail "$input: another picture from standard input"
done
head -c 300 in/x.exr | "$program" replay - -o cut.png 2>said.err && fail "a piece of an EXR"
grep -q "/dev/stdin: " said.err || fail "a piece of an EXR: $(cat said.err)"
"$program" replay - -o cut.png </dev/null 2>said.err && fail "nothing on standard input"
grep -q "standard input: nothing came; an image or a video was expected" said.err || fail "nothing came: $(cat said.err)"
absent cut.png

end_test
