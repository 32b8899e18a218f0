#!/bin/sh
# shape.sh: shape.py's rules for functions, for the product's C; first, that it finds planted faults.
set -eu
cd "$(dirname "$0")/../.."
command -v python3 >/dev/null || { echo "skipped: no python3"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() {
    echo "shape.sh: $*"
    exit 1
}

# repeat COUNT LINE
repeat() {
    for i in $(seq "$1"); do printf '%s\n' "$2"; done
}
# Reads C from the standard input; an empty SENTENCE: nothing is wrong with it.
# expect SENTENCE
expect() {
    cat >"$work/planted.c"
    said=$(python3 tests/tree/shape.py "$work/planted.c" | sed '$d') || :
    case $said in
    "") [ -z "$1" ] || fail "of planted code \"$1\" was expected, and nothing was said" ;;
    *) [ -n "$1" ] && [ "$said" = "$work/planted.c:$1" ] || fail "of planted code \"$1\" was expected: $said" ;;
    esac
}

# a function of so many lines
long() {
    echo 'int f(int x)'
    echo '{'
    repeat $(($1 - 4)) '    x++;'
    echo '    return x; /* } */'
    echo '}'
}
long 60 | expect ""
long 61 | expect "1: f has 61 lines, and 60 is the limit"
{ echo 'extern "C" {'; long 61; echo '}'; } | expect "2: f has 61 lines, and 60 is the limit"
long 61 | sed '1s/^/#define F /; s/$/ \\/' | expect "1: F: f has 61 lines, and 60 is the limit"

# a function of so many branches
branched() {
    echo 'int f(int x)'
    echo '{'
    repeat $(($1 - 8)) '    if (x) { x++; } else { x--; }'
    echo '    for (;;) while (x && x || x) switch (x ? x : "if (&&"[0]) { case 1: case 2: default: break; }'
    echo '}'
}
branched 20 | expect ""
branched 21 | expect "1: f has 21 branches, and 20 is the limit"

expect "" <<'C'
int f(int *a, int b[2])
{
    int c = 1, d = 2;
    struct s e = {1, 2}, *g = &e;
    char *h = 0, *i = h;
    for (c = 0, d = 1; c < d; c++, d--)
        b[c] = call(c, d);
    *a = (call(d), call(c)) ? 1 : 2;
    call(a), call(b);
    a = (int[]){1, 2};
    if (c)
        e = (struct s){.x = 1, .y = 2};
    return call(c, d++), 1;
}
C
for statement in '*a = 1, b[0] = 2;' 'a++, b++;' 'return b[0] = 1, 0;' 'if (a) a = b, *a = 3;' 'for (;;) b[0]++, b[1]--;' \
    'switch (*a) { case 1: a = b, *a = 4; }' '(*a) += 1, call(b);'; do
    printf 'int f(int *a, int b[2])\n{\n    b[1] = 0;\n    %s\n}\n' "$statement" | expect "4: f joins assignments by a comma"
done
expect "1: macro MUST hides a return" <<'C'
#define MUST(x) if (!(x)) return 1
C
expect "3: macro TRY hides a goto" <<'C'
#define TRY(x)  \
    do {        \
        if (!x) { goto end; } \
    } while (0)
C
expect "" <<'C'
#define WHOLE(x) static inline int x##_of(int y) { return x(y); }
#define EACH(i) for (int i = 0; i < 4; i++)
C

if [ -e .git ]; then
    files=$(git ls-files)
else
    files=$(find . -type f -not -path './build*' | sed 's|^\./||')
fi
python3 tests/tree/shape.py $(echo "$files" | grep -E '^(lib|drivers|apps|fixtures)/.*\.[ch]$')
