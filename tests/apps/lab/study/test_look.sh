#!/bin/sh
# pupil study look: relations that must hold between its tables' rows, and what is refused.
set -eu
. "$(dirname "$0")/../../../lib.sh"
use_pupil

"$program" study look spheres --size 24x24 -q >look.md 2>said.err
[ ! -s said.err ] || fail "on stderr: $(cat said.err)"
[ "$(grep -c '^## The lamp is switched' look.md)" = 2 ] || fail "not a part for each change: $(cat look.md)"
[ "$(grep -c '^| eye |' look.md)" = 4 ] || fail "no eye in each of four tables: $(cat look.md)"
grep -qw 'nan\|inf' look.md && fail "a number that is none: $(cat look.md)"
[ "$(grep -c "^| formula 3 |" look.md)" = 4 ] || fail "formula 3: $(cat look.md)"
grep '^| formula 3 |' look.md | sed 's/formula 3/formula 4/' >three.txt
grep '^| formula 4 |' look.md | cmp -s - three.txt || fail "formulas 3 and 4 differ: $(cat look.md)"

# rows by part (1: on, 2: off) and table (1: levels, 2: pictures)
awk -F '|' '
    /^## The lamp/ { part++; table = 0 }
    /^\| law/ { table++ }
    /^\| (formula|seconds|eye)/ { gsub(/ /, "", $2); for (i = 3; i < NF; i++) v[part, table, $2, i - 2] = $i + 0 }
    function near(a, b, by) { return a - b <= by && b - a <= by }
    function must(right, what) { if (!right) { print what; bad = 1 } }
    END {
        # the remaining distance after 15 and after 3 frames: 0.95^12
        must(near(v[1, 1, "formula4", 2] / v[1, 1, "formula4", 1], 0.95 ^ 12, 0.002), "formula 4 is not its closed form")
        for (t = 1; t <= 7; t++)
            must(near(v[1, 1, "formula1", t], -v[2, 1, "formula2", t], 0.011), "formulas 1 and 2 are no mirror images")
        # an eye: at once toward light, in minutes toward the dark
        must(v[1, 1, "eye", 1] > v[1, 1, "seconds", 1] && v[1, 1, "eye", 8] < 10, "the eye is slow toward light")
        must(v[2, 1, "eye", 5] > 0.5 && v[2, 1, "seconds", 5] < 0.01, "the eye is fast toward the dark")
        must(v[2, 2, "eye", 1] > 2 * v[2, 2, "seconds", 1], "no colour fades in the dark")
        for (part = 1; part <= 2; part++)
            for (law = 1; law <= 4; law++) {
                name = "formula" law
                must(v[part, 2, name, 2] >= v[part, 2, name, 1] && v[part, 2, name, 1] > 0, "colour of " name)
                must(v[part, 2, name, 4] <= v[part, 2, name, 3] && v[part, 2, name, 4] > 0, "contrast of " name)
            }
        exit bad
    }' look.md || fail "the tables are wrong: $(cat look.md)"
# in daylight there are no rods: the eye differs from the target only by its level
"$program" study look spheres --size 24x24 --eye 1e5 -q >day.md
fades() { grep '^| eye |' "$1" | sed -n 4p | cut -d'|' -f3; }
[ "$(fades day.md | tr -d ' .')" -lt "$(fades look.md | tr -d ' .')" ] || fail "colours fade in daylight: $(cat day.md)"

expect 2 "look: takes a scene" study look spheres --out x
expect 2 "look: takes a scene" study look --check
expect 2 "works only with pupil study look" study spheres --eye 3
expect 2 "one scene" study look spheres room
expect 2 "--eye 0: must be cd/m2" study look spheres --eye 0
expect 1 "nosuch" study look nosuch.scene
end_test
