#!/bin/sh
# guide.sh BUILD: the first page of docs/guide.md is right: each option of its commands exists, each function is
# declared, and each linked section exists.
set -u
build=$(cd "$1" && pwd)
root=$(cd "$(dirname "$0")/../.." && pwd)
guide=$root/docs/guide.md
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
failures=0
fail() {
    echo "FAILED: $*"
    failures=$((failures + 1))
}

sed -n '/^## You have/,/^## Replaying/p' "$guide" | grep '^| ' >"$work/page"
grep -oE '`[^`]+`' "$work/page" | tr -d '`' | sed 's/.*| *//' >"$work/typed"
grep '^pupil ' "$work/typed" >"$work/commands"
[ "$(wc -l <"$work/commands")" -ge 10 ] || fail "only $(wc -l <"$work/commands") commands on the page"
while read -r _ command; do
    # Split into words, without file names of this folder.
    set -f
    # The first option that does not exist is reported.
    "$build/apps/pupil" $command --no-such-option >"$work/said" 2>&1 </dev/null
    [ "$command" = list ] || grep -q -- '--no-such-option: no such option' "$work/said" ||
        fail "pupil $command: $(cat "$work/said")"
    set +f
done <"$work/commands"

for function in $(grep -oE '\bpupil_[a-z_]+[a-z]\(?' "$work/typed" | tr -d '(' | sort -u); do
    case $function in
    pupil_cv | pupil_ae | pupil_gles) ;;
    *) grep -qrE "\\b$function\(" "$root/lib/include" "$root/drivers/include" || fail "$function is not declared" ;;
    esac
done

# A heading as GitHub links to it: lower case, no punctuation, dashes for spaces.
sed -n 's/^##* //p' "$guide" | tr 'A-Z' 'a-z' | sed 's/[^a-z0-9 -]//g; s/ /-/g' >"$work/headings"
for section in $(grep -oE '\(#[a-z0-9-]+\)' "$guide" | tr -d '(#)' | sort -u); do
    grep -qx "$section" "$work/headings" || fail "docs/guide.md has no section #$section"
done
echo "$(wc -l <"$work/commands") commands, $failures failures"
[ $failures = 0 ]
