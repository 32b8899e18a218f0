#!/bin/sh
# hardened.sh PROGRAM: it is loaded at any address, its function tables are read-only once it runs, and it checks its
# stacks and the sizes in calls of the C library.
set -eu
program=$1
readelf=${READELF:-readelf}
command -v "$readelf" >/dev/null || { echo "skipped: no readelf"; exit 77; }
status=0
# has WHAT WORDS OPTIONS...
has() {
    what=$1 words=$2
    shift 2
    "$readelf" -W "$@" "$program" | grep -qE -- "$words" || { echo "hardened.sh: $program has no $what"; status=1; }
}
has "address of its own choice (PIE)" 'Type: *DYN' -h
has "RELRO" 'GNU_RELRO' -l
has "BIND_NOW" 'BIND_NOW|Flags:.* NOW' -d
has "guards on the stack" '__stack_chk_fail' --dyn-syms
has "checked calls" '_chk' --dyn-syms
"$readelf" -lW "$program" | grep -qE 'GNU_STACK.* RW ' || { echo "hardened.sh: $program has a stack that can be run"; status=1; }
[ $status = 0 ] && echo "hardened"
exit $status
