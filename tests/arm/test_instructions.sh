#!/bin/sh
# test_instructions.sh [ceilings|LIBRARY]: how many instructions 64-bit ARM executes per pixel, counted in qemu: the same
# on every machine. Each number has a ceiling in ceilings.txt, and a call without options costs what its kernels cost.
# With "ceilings" it prints ceilings 3 % above the counts. LIBRARY: see build.sh.
set -eu
cd "$(dirname "$0")"
. ./build.sh
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
library=${1:-}
[ "$library" != ceilings ] || library=
arm_build "$work" "$library"
arm_count "$work" kernels >"$work/kernels"
arm_count "$work" plain >"$work/plain"

# Level, what is done, input, output, picture, instructions per pixel. Those of plain are from the difference between a
# row and one twice as long, in which the work per row cancels.
awk -v OFMT=%.4f '
    FILENAME ~ /plain$/ {
        key = $1 " " $2 " " $3
        if (!(key in short))
            order[++n] = key
        if (key in short)
            slope[key] = ($5 - short[key]) / $4 * 2
        else
            short[key] = $5
        next
    }
    { print $1, $2, $3, $4, $5, $7 / $6 }
    END {
        for (i = 1; i <= n; i++) {
            key = order[i]
            split(key, part, " ")
            if (part[3] == "kernels" && part[1] == "meter")
                print "neon meter-kernel", part[2], "- ordinary", slope[key]
            if (part[3] == "kernels" && part[1] == "map") {
                print "neon map-kernels", part[2], "rgba8 ordinary", slope[key]
                print "neon map-blocks", part[2], "rgba8 ordinary", slope["map " part[2] " call"] - slope[key]
            }
        }
    }' "$work/kernels" "$work/plain" | sort -s -k1,1 -k2,2 -k5,5r >"$work/counted"

if [ "${1:-}" = ceilings ]; then
    awk '{ printf "%s %s %s %s %s %.2f\n", $1, $2, $3, $4, $5, $6 * 1.03 + 0.005 }' "$work/counted"
    exit
fi

status=0
awk '
    FILENAME ~ /ceilings.txt$/ {
        if ($0 ~ /^#/ || NF == 0)
            next
        key = $1 " " $2 " " $3 " " $4 " " $5
        if (NF != 6 || $6 !~ /^[0-9.]+$/ || key in ceiling) {
            print "FAILED: ceilings.txt, line " FNR ": not \"level what in out picture ceiling\", once each: " $0
            bad = 1
        }
        ceiling[key] = $6
        next
    }
    FNR == 1 {
        printf "%-7s %-16s %-9s %-6s %-9s %8s %8s\n", "level", "what", "in", "out", "picture", "a pixel", "ceiling"
    }
    {
        key = $1 " " $2 " " $3 " " $4 " " $5
        seen[key] = 1
        printf "%-7s %-16s %-9s %-6s %-9s %8.2f %8s\n", $1, $2, $3, $4, $5, $6, key in ceiling ? ceiling[key] : "none"
        if (!(key in ceiling))
            missing[++lack] = key
        else if ($6 > ceiling[key] + 0)
            above[++many] = sprintf("%s: %.4f instructions a pixel, above its ceiling of %s", key, $6, ceiling[key])
    }
    END {
        for (i = 1; i <= many; i++)
            print "FAILED: " above[i]
        for (i = 1; i <= lack; i++)
            print "FAILED: " missing[i] ": has no ceiling in tests/arm/ceilings.txt"
        for (key in ceiling)
            if (!(key in seen)) {
                print "FAILED: " key ": has a ceiling in tests/arm/ceilings.txt, and was not counted"
                bad = 1
            }
        if (bad || many || lack || !FNR)
            print "rerun: sh tests/arm/test_instructions.sh"
        exit bad || many || lack || !FNR
    }' ceilings.txt "$work/counted" || status=1

# Unused options cost nothing: between the shorter and the longer row a call grows by exactly as many instructions as
# its kernels. Options that are used cost something, or this test could not fail.
awk '
    {
        key = $1 " " $2 " " $3
        if (key in short) {
            more[key] = $5 - short[key]
        } else {
            short[key] = $5
            order[++keys] = key
        }
        total[key] = $5
    }
    function fails(text) { print "FAILED: " text; bad = 1 }
    END {
        print ""
        printf "%-9s %10s %10s %10s %9s   instructions for 2048 pixels more\n", "meter", "kernel", "call", "histogram", "same"
        for (k = 1; k <= keys; k++) {
            key = order[k]
            split(key, part, " ")
            if (part[1] != "meter" || part[3] != "kernels")
                continue
            n++
            in_format = part[2]
            call = "meter " in_format " call"
            histogram = more["meter " in_format " histogram"]
            printf "%-9s %10d %10d %10d %9s\n", in_format, more[key], more[call], histogram,
                more[key] == more[call] ? "yes" : "no"
            if (more[key] != more[call])
                fails("meter " in_format ": a call without any option takes " more[call] - more[key] \
                      " instructions more than its kernel for 2048 pixels more: these must be equal")
            split("histogram trimming following-white mask", option, " ")
            for (i = 1; i <= 4; i++)
                if (!(total["meter " in_format " " option[i]] > total[call]))
                    fails("meter " in_format ": with " option[i] " it takes " total["meter " in_format " " option[i]] \
                          " instructions, and without it " total[call])
        }
        if (!n)
            fails("nothing was counted by count_arm plain")
        if (bad)
            print "rerun: sh tests/arm/test_instructions.sh"
        exit bad
    }' "$work/plain" || status=1
exit $status
