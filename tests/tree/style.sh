#!/bin/sh
# style.sh: C and C++ files in git follow .clang-format; no line of these, CMake or Python is over 120 characters.
set -eu
cd "$(dirname "$0")/../.."
status=0
if [ -e .git ]; then
    files=$(git ls-files)
else
    files=$(find . -type f -not -path './build*' | sed 's|^\./||')
fi
sources=$(echo "$files" | grep -E '\.([ch]|[ch]pp)$' | grep -v 'lib/kernels/tables\.c$')
long=$(grep -nE '^.{121,}' $(echo "$files" | grep -v 'lib/kernels/tables\.c$' |
    grep -E '\.([ch]|[ch]pp|cmake|py|in)$|CMakeLists.txt$') || :)
if [ -n "$long" ]; then
    echo "style.sh: lines over 120 characters:"
    echo "$long" | cut -c1-140
    status=1
fi
# Other versions of clang-format break some lines elsewhere.
case $(clang-format --version 2>/dev/null) in
*" version 14."*) clang-format --dry-run -Werror $sources || status=1 ;;
"") echo "skipped: no clang-format"; [ $status != 0 ] || exit 77 ;;
*) echo "skipped: the style is that of clang-format 14"; [ $status != 0 ] || exit 76 ;;
esac
exit $status
