#!/bin/sh
# sweep.sh ARGUMENTS...: sweep.py, where what it needs is there and may be used.
set -eu
command -v python3 >/dev/null || { echo "skipped: no python3"; exit 77; }
command -v strace >/dev/null || { echo "skipped: no strace: the packages are listed in test.sh"; exit 77; }
strace -qq -o /dev/null true 2>/dev/null || { echo "skipped: no program may be traced here"; exit 76; }
PYTHONDONTWRITEBYTECODE=1 exec python3 "$(dirname "$0")/sweep.py" "$@"
