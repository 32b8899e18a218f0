#!/bin/sh
# model.sh: what metering and mapping 1080p30 would take of one core of Cortex-A53, A72 and A76, by a model: how often
# each loop is executed, counted in qemu, times its cycles by llvm-mca. docs/boards.md says what the model leaves out.
# LLVM_MCA names an llvm-mca other than llvm-mca-19.
set -eu
cd "$(dirname "$0")"
. ./build.sh
mca=${LLVM_MCA:-llvm-mca-19}
command -v "$mca" >/dev/null || { echo "skipped: no $mca"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
arm_build "$work"
arm_count "$work" kernels ,blocks=on >"$work/blocks"
aarch64-linux-gnu-objdump -d --no-show-raw-insn "$work/count_arm" >"$work/code"

# LLVM has no model of the Cortex-A76 and silently uses that of the Cortex-A57, as for the A72; the Neoverse N1 is the
# A76's server sibling.
cores='A53 cortex-a53 1.4
A72 cortex-a72 1.5
A76 neoverse-n1 2.4'

# loops WORK: the loops of one line of count_arm, as assembler in $work/loop.N.s; prints the line's pixels and
# instructions, then for each loop N, its function, how often it is executed, and its instructions. A loop is a run of
# instructions, in the order of their addresses, that are executed at least an eighth as often as any in their function
# (vector loops are next to loops over pixels), up to the branch back.
loops() {
    rm -f "$work"/loop.*
    awk -v work="$1" -v into="$work/loop" '
        function number(hex,    i, n) {
            for (i = 1; i <= length(hex); i++)
                n = n * 16 + index("123456789abcdef", substr(hex, i, 1))
            return n
        }
        function finish(    i, file, text) {
            if (!size)
                return
            file = into "." ++files ".s"
            print ".Lhere:" >file
            for (i = 1; i <= size; i++) {
                text = body[i]
                sub(/[ \t]*\/\/.*/, "", text)
                sub(/[0-9a-f]+ <[^>]*>/, ".Lhere", text)
                print text >file
            }
            close(file)
            print files, name, sum / size, size
            size = sum = 0
        }
        function end_of_function(    i, a, target) {
            for (i = 1; i <= lines; i++) {
                a = address[i]
                if (times[a] * 8 < most || most < 16)
                    continue
                if (!size)
                    first = a
                body[++size] = code[i]
                sum += times[a]
                if (match(code[i], /[0-9a-f]+ </)) {
                    target = number(substr(code[i], RSTART, RLENGTH - 2))
                    if (target >= first && target <= a && code[i] ~ /^(b|cb|tb)/)
                        finish()
                }
            }
            finish()
            lines = most = 0
        }
        FILENAME ~ /blocks$/ {
            if ($1 != "block") {
                on = $1 " " $2 " " $3 " " $4 " " $5 == work
                if (on)
                    print $6, $7
            } else if (on)
                for (i = 0; i < $3; i++)
                    times[number($2) + 4 * i] += $4
            next
        }
        /^[0-9a-f]+ <.*>:$/ {
            end_of_function()
            name = substr($2, 2, length($2) - 3)
            next
        }
        /^ *[0-9a-f]+:\t/ {
            a = $1
            sub(/:/, "", a)
            a = number(a)
            if (!(a in times))
                next
            address[++lines] = a
            code[lines] = substr($0, index($0, "\t") + 1)
            if (times[a] > most)
                most = times[a]
        }
        END { end_of_function() }' "$work/blocks" "$work/code"
}

# cycles FILE MODEL: of one iteration in a long run of the loop
cycles() {
    for turns in 100 300; do
        "$mca" -mtriple=aarch64 -mcpu="$2" -iterations=$turns "$1" 2>/dev/null |
            awk '/^Total Cycles:/ { print $3 }'
    done | awk 'NR == 1 { short = $1 } NR == 2 { print ($1 - short) / 200 }'
}

# model WORK: adds "WORK|core|cycles a pixel|instructions a pixel" to $work/models; prints the loops.
model() {
    loops "$1" >"$work/loops"
    echo "$cores" >"$work/cores"
    while read -r core cpu _; do
        sed 1d "$work/loops" | while read -r n name times size; do
            echo "$n $name $times $size $(cycles "$work/loop.$n.s" "$cpu" </dev/null)"
        done >"$work/cycles"
        awk -v work="$1" -v core="$core" -v models="$work/models" -v list="$([ "$core" = A53 ] && echo 1)" '
            NR == FNR {
                if (NR == 1) {
                    pixels = $1
                    all = $2
                }
                next
            }
            NF != 5 { print "model.sh: " $2 ": llvm-mca gives no cycles" >"/dev/stderr"; bad = 1; exit }
            {
                in_loops += $3 * $4
                cycles += $3 * $5
                if (list && $3 * $4 > all / 50)
                    printf "    %-20s %4d instructions, %8.0f times: %6.2f a pixel\n", $2, $4, $3, $3 * $4 / pixels
            }
            END {
                if (bad)
                    exit 1
                if (in_loops < 0.85 * all) {
                    print "model.sh: " work ": only " in_loops " of " all " instructions are in loops" >"/dev/stderr"
                    exit 1
                }
                if (list)
                    printf "%s: %.2f instructions a pixel, %.0f %% of them in loops\n", work, all / pixels,
                        100 * in_loops / all
                print work "|" core "|" cycles / pixels * all / in_loops "|" all / pixels >>models
            }' "$work/loops" "$work/cycles"
    done <"$work/cores"
}

: >"$work/models"
for input in rgba16f rgba32f rgba16 rgba8 yuyv nv12 grey8 bayer10 bayer10p; do
    model "neon meter-rows $input - ordinary"
    model "neon map-rows $input rgba8 ordinary"
done

echo
echo "1080p30 (62.2 million pixels a second), per cent of one core; in parentheses cycles a pixel"
printf '| input | instructions a pixel: meter, map |'
echo "$cores" | while read -r core _ clock; do
    printf ' %s at %s GHz: meter | meter and map |' "$core" "$clock"
done
printf '\n|---|--:|--:|--:|--:|--:|--:|--:|\n'
awk -F '|' -v cores="$cores" '
    {
        split($1, part, " ")
        if (!(part[3] in seen))
            order[++n] = part[3]
        seen[part[3]] = 1
        cycles[part[3], part[2], $2] = $3
        count[part[3], part[2]] = $4
    }
    END {
        lines = split(cores, line, "\n")
        for (i = 1; i <= n; i++) {
            f = order[i]
            printf "| %s | %.1f, %.1f |", f, count[f, "meter-rows"], count[f, "map-rows"]
            for (j = 1; j <= lines; j++) {
                split(line[j], c, " ")
                per_cent = 62.208e6 / (c[3] * 1e9) * 100
                meter = cycles[f, "meter-rows", c[1]]
                both = meter + cycles[f, "map-rows", c[1]]
                printf " %.0f (%.1f) | %.0f (%.1f) |", meter * per_cent, meter, both * per_cent, both
            }
            print ""
        }
    }' "$work/models"
