#!/bin/sh
# diff.sh LIBRARY: abidiff between the last release (libpupil.abi, as abidw wrote it) and LIBRARY, which has debug
# information. Functions may be added; everything else needs another soname. Growth of a struct that check.sh allows
# gets an entry with its reason in tests/abi/allowed.abignore (abidiff --suppressions). Then the same
# with a dump in which one thing is changed: abidiff must find it. diff.sh --update LIBRARY: writes libpupil.abi. Only
# at a release. The one of 0.2.0 is from commit 8d67809, the last one in its part of CHANGELOG.md.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
headers=$here/../../lib/include dump=$here/libpupil.abi
command -v abidiff >/dev/null || { echo "skipped: no abidiff (abigail-tools)"; exit 77; }
case $(uname -m) in
x86_64) ;;
*) echo "skipped: libpupil.abi is that of x86-64"; exit 77 ;;
esac
if [ "$1" = --update ]; then
    abidw --drop-private-types --no-show-locs --no-comp-dir-path --no-corpus-path --no-parameter-names --no-elf-needed \
        --no-write-default-sizes --type-id-style hash --headers-dir "$headers" "$2" |
        sed "s|\(<abi-instr .*path='\)[^']*/lib/|\1lib/|" >"$dump"
    exit
fi
library=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

allowed=
[ ! -f "$here/allowed.abignore" ] || allowed="--suppressions $here/allowed.abignore"

# $allowed: unquoted on purpose.
compare() { abidiff --no-added-syms $allowed "$1" "$library" >"$work/log" 2>&1; }

compare "$dump" || {
    cat "$work/log"
    echo "diff.sh: the library's interface is not that of the last release (tests/abi/libpupil.abi)"
    exit 1
}
structs=$(grep -c "<class-decl .*size-in-bits" "$dump")
echo "$(grep -c "<elf-symbol " "$dump") symbols and $structs structs are as in the last release"

status=0
while read -r what from to; do
    sed "s/$from/$to/" "$dump" >"$work/changed.abi"
    if cmp -s "$dump" "$work/changed.abi"; then
        echo "diff.sh: $what: $from is not in the dump"
        status=1
    elif compare "$work/changed.abi"; then
        echo "diff.sh: $what is not seen"
        status=1
    else
        echo "seen: $what"
    fi
done <<'CHANGES'
a_function_that_is_gone name='pupil_adapt' name='pupil_gone'
a_struct_of_another_size \(name='pupil_exposure'.size-in-bits=\)'960' \1'1024'
a_field_at_another_offset layout-offset-in-bits='384' layout-offset-in-bits='392'
a_field_of_another_type \(name='dt_s'.type-id=\)'a0eb0f08' \1'9c313c2d'
CHANGES
exit $status
