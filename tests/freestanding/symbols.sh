#!/bin/sh
# symbols.sh ARCHIVE [SHARED_LIBRARY]: the core calls nothing but four functions that every compiler may call on its own
# (no allocator, no libm, no stdio), and all global names of both libraries begin with pupil_. The exports of the shared
# library have the version of its soname.
set -eu
archive=$1
shared=${2:-}
NM=${NM:-nm}

defined=$("$NM" -g --defined-only "$archive" | awk 'NF == 3 { print $3 }' | sort -u)
[ -n "$defined" ] || { echo "symbols.sh: $archive defines nothing"; exit 1; }

# A shared object from gcc also refers to its own global offset table.
undefined=$("$NM" -g --undefined-only "$archive" | awk 'NF == 2 { print $2 }' | sort -u |
    grep -vxF "$defined" | grep -vxE 'memcpy|memmove|memset|memcmp|_GLOBAL_OFFSET_TABLE_' || :)
foreign=$(echo "$defined" | grep -v '^pupil_' || :)

status=0
if [ -n "$undefined" ]; then
    echo "symbols.sh: $archive calls outside itself: $(echo $undefined)"
    status=1
fi
if [ -n "$foreign" ]; then
    echo "symbols.sh: $archive defines names without pupil_: $(echo $foreign)"
    status=1
fi
echo "$archive: $(echo "$defined" | wc -l) global names, all pupil_"

if [ -n "$shared" ]; then
    soname=$(readelf -d "$shared" | sed -n 's/.*SONAME.*\[\(.*\)\]/\1/p')
    version=PUPIL_${soname#*.so.}
    exported=$("$NM" -D --defined-only --with-symbol-versions "$shared" | awk '$2 != "A" { print $3 }' | sort -u)
    others=$(echo "$exported" | grep -v "@@$version\$" || :)
    if [ -n "$others" ]; then
        echo "symbols.sh: these do not have the version $version: $(echo $others)"
        status=1
    fi
    exported=$(echo "$exported" | sed 's/@@.*//')
    # The library exports exactly what the headers declare.
    promised=$(cat "$(dirname "$0")"/../../lib/include/pupil/*.h | tr '\n' ' ' |
        grep -oE 'PUPIL_API [a-z0-9_ *]*pupil_[a-z0-9_]+\(' | grep -oE 'pupil_[a-z0-9_]+\($' | tr -d '(' | sort -u)
    if [ "$exported" != "$promised" ]; then
        echo "symbols.sh: exported and promised names differ:"
        { echo "$exported" | sed 's/$/ exported/'; echo "$promised" | sed 's/$/ promised/'; } | sort | uniq |
            awk '{ n[$1]++; w[$1] = $2 } END { for (k in n) if (n[k] == 1) print "    " k " only " w[k] }'
        status=1
    fi
    echo "$shared: $(echo "$exported" | wc -l) exported names, those of the headers"
fi
exit $status
