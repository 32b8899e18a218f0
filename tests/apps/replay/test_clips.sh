#!/bin/sh
# Clips as from phones: stored sideways, with sound. Needs ffmpeg, which makes and checks them.
set -u
. "$(dirname "$0")/../../lib.sh"
use_pupil
needs ffmpeg ffprobe

# say FILE ENTRIES: these entries of its streams, a line each
# turn ANGLE FROM TO: clockwise. FFmpeg 6 has an option for it, FFmpeg 7 no longer takes the metadata.
turn() {
    if ffmpeg -hide_banner -h full 2>&1 | grep -q -- -display_rotation; then
        ffmpeg -v error -nostdin -y -display_rotation:v:0 "-$1" -i "$2" -c copy "$3"
    else
        ffmpeg -v error -nostdin -y -i "$2" -c copy -metadata:s:v:0 rotate="$1" "$3"
    fi
}
# in_mp4_or_named WORDS FROM TO: an mp4 has the sound, as FFmpeg 6 and later write it, or a sentence says that it has not
in_mp4_or_named() {
    expect 0 "" replay "$2" -o "$3"
    if [ "$(say "$3" stream=codec_type | wc -l)" = 2 ]; then
        ! grep -q "without its sound" said.err || fail "$3 has the sound, and says: $(cat said.err)"
    else
        grep -qF -- "$1" said.err || fail "$3: no '$1' in: $(cat said.err)"
    fi
}
say() { ffprobe -v error -show_entries "$2" -of csv=p=0 "$1"; }

ffmpeg -v error -nostdin -f lavfi -i testsrc2=s=96x64:r=25:d=2 -f lavfi -i "sine=f=440:d=2,volume=0.5" -c:v libx264 -pix_fmt yuv420p \
    -c:a aac land.mp4 2>said.err || skip "this ffmpeg has no libx264 or no aac: $(cat said.err)"

# upright, as ffmpeg turns them; --no-rotate leaves them
for angle in 90 180 270; do
    turn $angle land.mp4 turned.mp4
    expect 0 "" replay turned.mp4 -q -n 1 -o turned.png -y
    ffmpeg -v error -nostdin -y -i turned.mp4 -frames:v 1 want.png
    [ "$(say turned.png stream=width,height)" = "$(say want.png stream=width,height)" ] || fail "$angle degrees: another size"
    # Only the exposure differs, equally for all angles: the unrotated picture is the reference.
    likeness=$(ffmpeg -nostdin -i turned.png -i want.png -lavfi psnr -f null - 2>&1 | grep -o 'average:[0-9.]*')
    [ $angle = 90 ] && first=$likeness
    [ -n "$likeness" ] && [ "$likeness" = "$first" ] || fail "$angle degrees: $likeness, at 90 $first"
done
expect 0 "" replay turned.mp4 -q -n 1 -o stored.png --no-rotate
[ "$(say stored.png stream=width,height)" = 96,64 ] || fail "--no-rotate: $(say stored.png stream=width,height)"
expect 0 "" replay land.mp4 -q -n 1 -o land.png
cmp -s land.png stored.png || fail "--no-rotate is not the picture as it is stored"
ffmpeg -v error -nostdin -i land.png -i want.png -lavfi "[0]transpose=2[a];[a][1]psnr" -f null - 2>said.err || fail "$(cat said.err)"

# the sound: unchanged, from the first frame to the last
sound() { ffmpeg -v error -nostdin -i "$1" -map 0:a -f framemd5 - 2>said.err | grep -v '^#' | awk -F, '{ print $6 }'; }
packets() { ffmpeg -v error -nostdin -i "$1" -map 0:a -c copy -f framemd5 - | grep -v '^#' | awk -F, '{ print $6 }'; }
packets land.mp4 >want.txt
for kind in mp4 mov mkv; do
    expect 0 "" replay turned.mp4 -q -o whole.$kind
    packets whole.$kind >got.txt
    cmp -s want.txt got.txt || fail "$kind: the sound is another one"
    say whole.$kind stream=codec_type | grep -q audio || fail "$kind: no sound"
done
[ "$(sound whole.mov | wc -l)" -gt 80 ] || fail "the sound cannot be decoded: $(cat said.err)"
expect 0 "" replay land.mp4 -q -n 10 -o short.mkv
last=$(ffprobe -v error -select_streams a -show_entries packet=pts_time -of csv=p=0 short.mkv | tail -n 1)
awk -v last="$last" 'BEGIN { exit !(last > 0.35 && last < 0.43) }' || fail "the sound of 0.4 s (and 0.02 of what is before it) ends at $last"

# cut short: nothing, or with --keep-going the existing frames and their sound; FFmpeg 9 adds the position
head -c $(($(wc -c <whole.mkv) * 6 / 10)) whole.mkv >half.mkv
expect 1 "frames: damaged or cut short: File ended prematurely" replay half.mkv -o half.mp4
grep -q '; --keep-going skips such frames$' said.err || fail "nothing of --keep-going: $(cat said.err)"
absent half.mp4
expect 3 "frames: damaged or cut short: File ended prematurely" replay half.mkv --keep-going -o half.mp4
grep -q '; skipped$' said.err || fail "nothing of skipping: $(cat said.err)"
frames=$(ffprobe -v error -count_frames -select_streams v -show_entries stream=nb_read_frames -of csv=p=0 half.mp4)
[ "$frames" -gt 10 ] && grep -q "ends after $frames frames" said.err || fail "$frames frames: $(cat said.err)"
say half.mp4 stream=codec_type | grep -q audio || fail "half.mp4 has no sound"

# if the output cannot have sound, that is reported
expect 0 "a.y4m is without its sound: Y4M has none" replay land.mp4 -o a.y4m
expect 0 "--hold changes the pace" replay land.mp4 --hold 2 -o held.mp4
[ "$(say held.mp4 stream=codec_type)" = video ] || fail "--hold has sound"
ffmpeg -v error -nostdin -i land.mp4 -c:v copy -c:a pcm_s16le pcm.mov
in_mp4_or_named "b.mp4 is without its sound: mp4 has no place for pcm_s16le" pcm.mov b.mp4
expect 0 "" replay pcm.mov -o b.mov
[ "$(say b.mov stream=codec_type | wc -l)" = 2 ] || fail "pcm in .mov is left out"
"$program" replay - -o piped.mkv <whole.mkv 2>said.err || fail "stdin: $(cat said.err)"
grep -q "piped.mkv is without its sound: a pipe is read once; name the file" said.err || fail "stdin: $(cat said.err)"
mkfifo pipe
cat whole.mkv >pipe &
expect 0 "fifo.mkv is without its sound: a pipe is read once" replay pipe -o fifo.mkv
ffmpeg -v error -nostdin -i land.mp4 -c:v copy -c:a flac flac.mkv
in_mp4_or_named "d.mp4 is without its sound: mp4 has no place for flac; a .mkv has" flac.mkv d.mp4
ffmpeg -v error -nostdin -i land.mp4 -c:v copy -c:a pcm_mulaw mulaw.mkv
expect 0 "" replay mulaw.mkv -o d.mkv
[ "$(say d.mkv stream=codec_name)" = "$(printf 'h264\npcm_mulaw')" ] || fail "mu-law in .mkv is left out"
ffmpeg -v error -nostdin -i land.mp4 -c copy -an silent.mp4
expect 0 "" replay silent.mp4 -o c.mp4
grep -q sound said.err && fail "sound of a silent clip: $(cat said.err)"

# frames of different durations: Y4M, which has one rate, repeats them
ffmpeg -v error -nostdin -i silent.mp4 -vf "select='not(between(n,10,29))'" -fps_mode vfr -c:v libx264 gap.mp4
expect 0 "" replay gap.mp4 -q -o gap.y4m -y
frames=$(ffprobe -v error -count_frames -show_entries stream=nb_read_frames -of csv=p=0 gap.y4m)
[ "$frames" = 50 ] || fail "two seconds at 25 frames/s have $frames frames in .y4m"

# non-square pixels, also with a rotated picture
ffmpeg -v error -nostdin -i silent.mp4 -c:v libx264 -vf setsar=16/15 wide.mp4
turn 90 wide.mp4 tall.mp4
expect 0 "" replay wide.mp4 -q -o shown.mkv
[ "$(say shown.mkv stream=sample_aspect_ratio)" = 16:15 ] || fail "wide: $(say shown.mkv stream=sample_aspect_ratio)"
expect 0 "" replay tall.mp4 -q -o shown.mp4
[ "$(say shown.mp4 stream=sample_aspect_ratio)" = 15:16 ] || fail "tall: $(say shown.mp4 stream=sample_aspect_ratio)"
expect 0 "" replay wide.mp4 -q -o shown.y4m
head -n 1 shown.y4m | grep -q " A16:15 " || fail "wide: $(head -n 1 shown.y4m)"

# The pipes of docs/guide.md, verbatim: HDR10 frames come through them as from the file.
guide=$(dirname "$0")/../../../docs/guide.md
ffmpeg -v error -nostdin -f lavfi -i testsrc2=s=96x64:r=25:d=0.4 -pix_fmt yuv420p10le -color_primaries bt2020 -color_trc smpte2084 \
    -colorspace bt2020nc -c:v ffv1 hdr10.mkv
expect 0 "" replay hdr10.mkv -q -o file.y4m
grep -E '^    ffmpeg .*[|] pupil replay - ' "$guide" >pipes
[ "$(wc -l <pipes)" = 2 ] || fail "other pipes in docs/guide.md: $(cat pipes)"
while read -r line; do
    from=$(echo "${line%% | pupil*}" | sed 's/-i [a-z0-9.]*/-v error -nostdin -i hdr10.mkv/; s/-vf bwdif//')
    $from | "$program" replay - -q -o pipe.y4m -y 2>said.err || fail "$line: $(cat said.err)"
    cmp -s file.y4m pipe.y4m || fail "$line: other frames than those of the file"
done <pipes

# a file at its size limit
(ulimit -f 2 && "$program" replay land.mp4 -q -o full.mp4 2>said.err) && fail "a file beyond its limit is made"
grep -q "full.mp4: cannot be written: File too large" said.err || fail "beyond the limit: $(cat said.err)"
ls | grep -q full && fail "beyond the limit: $(ls | grep full)"

# frames of a mosaic, of 8 bits and of 16 in either order of bytes: as the same bytes without a header
ffmpeg -v error -nostdin -f lavfi -i "testsrc2=s=64x48:r=30" -frames:v 6 -pix_fmt gray -f rawvideo eight.raw
ffmpeg -v error -nostdin -f lavfi -i "testsrc2=s=64x48:r=30" -frames:v 6 -pix_fmt gray16le -f rawvideo little.raw
ffmpeg -v error -nostdin -f lavfi -i "testsrc2=s=64x48:r=30" -frames:v 6 -pix_fmt gray16be -f rawvideo big.raw
while read -r file format fourcc; do
    ffmpeg -v error -nostdin -f rawvideo -pix_fmt "$format" -s 64x48 -r 30 -i "$file" -c copy "$format.nut" ||
        fail "ffmpeg makes no $format"
    expect 0 "" replay "$format.nut" -o mosaic.y4m -y
    expect 0 "" replay "raw:$file,format=$fourcc,size=64x48" -o raw.y4m -y
    [ "$file" = big.raw ] || cmp -s mosaic.y4m raw.y4m || fail "$format is not raw:$file"
    [ "$file" != little.raw ] || cp mosaic.y4m little.y4m
    [ "$file" != big.raw ] || cmp -s mosaic.y4m little.y4m || fail "$format is not the other order of bytes"
done <<END
eight.raw bayer_rggb8 RGGB
eight.raw bayer_grbg8 GRBG
eight.raw bayer_gbrg8 GBRG
eight.raw bayer_bggr8 BA81
little.raw bayer_rggb16le RG16
big.raw bayer_rggb16be RG16
END
ffmpeg -v error -nostdin -f rawvideo -pix_fmt bayer_rggb8 -s 62x31 -i eight.raw -frames:v 1 -c copy odd.nut
expect 1 "a mosaic of 62 x 31 pixels; it has even sides" replay odd.nut -o odd.y4m

end_test
