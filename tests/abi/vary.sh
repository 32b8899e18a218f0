#!/bin/sh
# vary.sh added|removed STRUCTS OUT: the public headers as another version might have them, in OUT/pupil. STRUCTS
# ("all": every struct that begins with size_bytes) have one more field at the end, or lack their last one.
set -eu
how=$1 structs=$2 out=$3
here=$(cd "$(dirname "$0")" && pwd)
mkdir -p "$out/pupil"
for header in "$here"/../../lib/include/pupil/*.h; do
    awk -v how="$how" -v structs="$structs" '
        BEGIN { removed = ""; n = split(structs, name, " "); for (i = 1; i <= n; i++) wanted["} " name[i] ";"] = 1 }
        /^typedef struct pupil_[a-z_]* \{/ { inside = 1; fields = 0 }
        !inside && removed != "" && index($0, "." removed " ") { next } # inline functions
        !inside { print; next }
        { line[++lines] = $0 }
        # a field, not the rest of its comment below it
        /^    [a-z]/ { last = lines; if (!fields++) grows = / size_bytes;/ }
        /^\} pupil_/ {
            if (grows && (structs == "all" || $0 in wanted)) {
                if (how == "added") {
                    line[lines + 1] = line[lines]
                    line[lines++] = "    uint64_t added;"
                } else {
                    removed = line[last]
                    sub(/(\[[^;]*)?;.*/, "", removed)
                    sub(/.*[ *]/, "", removed)
                    line[last] = line[lines]
                    lines = last
                }
            }
            for (i = 1; i <= lines; i++)
                print line[i]
            inside = lines = 0
        }' "$header" >"$out/pupil/$(basename "$header")"
done
