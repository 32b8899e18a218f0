#!/bin/sh
# size.sh: prints how large the library is, in lines and in state (in code: stack.sh); fails where the core outgrows
# 3,000 lines.
set -eu
cd "$(dirname "$0")/../.."
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

count() {
    cat "$@" | grep -cv '^[[:space:]]*$'
}
# Tables are printed by a script, which counts in their place.
# The levels with vectors say again, faster, what the scalar one says: they are counted by themselves.
levels=$(ls lib/kernels/vector*.h lib/kernels/neon*.[ch] lib/kernels/avx*.[ch])
reference=$(ls lib/kernels/*.[ch] lib/kernels/*.py | grep -v -e '/tables\.c$' $(printf ' -e %s' $levels))
lines=$(count lib/core/*.[ch])
echo "lib/core: $lines lines that are not blank; beside it the other rooms, $(count lib/base/*.[ch] lib/flicker/*.[ch] lib/row_gain/*.[ch] lib/sensor/*.[ch]), the kernels of the" \
    "reference, $(count $reference), the levels with vectors, $(count $levels), and lib/kernels/tables.c, which is" \
    "generated, $(count lib/kernels/tables.c)"
echo "public headers: $(count lib/include/pupil/*.h) lines"

cat >"$work/sizes.c" <<'C'
#include "pupil/pupil.h"
#include <stdio.h>
int main(void)
{
    printf("sizeof: pupil_t %zu, pupil_stats %zu, pupil_config %zu bytes\n", sizeof(pupil_t), sizeof(pupil_stats),
           sizeof(pupil_config));
    return 0;
}
C
${CC:-cc} -std=c11 -Ilib/include "$work/sizes.c" -o "$work/sizes"
"$work/sizes"

if [ "$lines" -ge 3000 ]; then
    echo "size.sh: the core has $lines lines, and 3,000 is the limit"
    exit 1
fi
