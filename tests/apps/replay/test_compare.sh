#!/bin/sh
# --compare: each half is the result of a run with only its settings, under a label; options that exclude it are
# refused.
set -u
. "$(dirname "$0")/../../lib.sh"
use_pupil
needs python3

walk="replay synth:walk --size 160x90 -n 12 -q"

# halves COMPARED LEFT RIGHT: Y4M files of 4:4:4; all except the label's bar, 11 rows, is the same in every frame
halves() {
    python3 - "$@" <<'END'
import sys

def frames(path):
    data = open(path, "rb").read()
    head, rest = data.split(b"\n", 1)
    width, height = (int(word[1:]) for word in head.split()[1:3])
    size = 3 * width * height
    return width, height, [rest[i + 6:i + 6 + size] for i in range(0, len(rest), 6 + size)]

both, *alone = (frames(path) for path in sys.argv[1:])
width, height, shown = both
assert len(shown) == 12 and all(w * 2 == width and h == height and len(f) == 12 for w, h, f in alone), both[:2]
bar = 11
for i, frame in enumerate(shown):
    for plane in range(3):
        for y in range(height):
            row = frame[(plane * height + y) * width:][:width]
            for side, (w, h, single) in enumerate(alone):
                want = single[i][(plane * h + y) * w:][:w]
                got = row[side * w:][:w]
                assert got == want if y >= bar else plane or got != want, (i, plane, y, side)
END
}

"$program" $walk -o plain.y4m && "$program" $walk --key 0.3 --tau-dark 3 -o key.y4m || fail "the runs alone"
expect 0 "" $walk --compare "" "--key 0.3 --tau-dark 3" -o both.y4m
halves both.y4m plain.y4m key.y4m || fail "the halves are not the runs"
expect 0 "" $walk --compare "--key 0.3 --tau-dark 3" "" -o turned.y4m --threads 1
halves turned.y4m key.y4m plain.y4m || fail "the halves the other way round"

# options outside the quotes apply to both halves, those inside replace them
"$program" $walk --ev 1 -o ev.y4m && "$program" $walk --ev 1 --law 3 --weight 0.2 --tone adjust -o law.y4m || fail "the runs alone"
expect 0 "" $walk --ev 1 --compare "" "--law 3 --weight 0.2 --tone adjust" -o outer.y4m
halves outer.y4m ev.y4m law.y4m || fail "options outside of the quotes"
expect 0 "" $walk --key-at -1:0.06,5:0.18 --compare "--key-at -2:0.05,5:0.18" "--key 0.18" -o inner.y4m
"$program" $walk --key-at -2:0.05,5:0.18 -o at.y4m || fail "the run alone"
halves inner.y4m at.y4m plain.y4m || fail "options inside of the quotes"

# pictures, one by one; and a video by a muxer
expect 0 "" $walk --reset-each --compare "" "--lock --metering spot" -o folder
expect 0 "" $walk --compare "" "--fused$(printf ' --ev %d' $(yes 1 | head -n 80))" -o both.mp4 # any number of options
[ -s both.mp4 ] && [ -s folder/frame_000011.png ] || fail "no folder or video"

while IFS='|' read -r words a b more; do
    # shellcheck disable=SC2086 # words
    expect 2 "$words" $walk -o none.mp4 --compare "$a" "$b" $more
done <<END
--compare "--keey 0.3": --keey: no such option of pupil replay; perhaps --key||--keey 0.3|
--compare "--key 3": --key 3: must be from 0.001 to 1|--key 3||
--compare "a.mp4": must be two settings in quotes|a.mp4|b.mp4|
--out is of both: outside of the quotes||-o x.mp4|
--transfer is of both||--transfer linear|
--threads is of both|--threads 2||
--compare "--help": must be two settings||--help|
--compare: makes pictures and videos; --stats is of one setting||--key 0.3|--stats s.csv
--compare: makes pictures and videos; --explain is||--key 0.3|--explain 3
--tau-dark: belongs to the default law||--law 1 --tau-dark 3|
--key and --key-at: one of them||--key 0.2 --key-at 0:0.1|
END
expect 2 "a setting of over 1023 characters" $walk -o none.mp4 --compare "" "$(printf '%01024d' 0)"
expect 2 "-o out.mp4 or another output is missing" $walk --compare "" "--key 0.3"
expect 2 "its value is missing; 'pupil replay --help' has more; it takes two settings in quotes" $walk --compare "--ev 1" -o none.mp4
expect 2 "--compare: its second value is missing" $walk -o none.mp4 --compare ""
expect 1 "side by side are wider than 16384" replay synth:walk --size 8194x2 -n 1 -o none.mp4 --compare "" "--key 0.3"
absent none.mp4 x.mp4

end_test
