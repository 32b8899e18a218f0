#!/bin/sh
# sweep.sh ARGUMENTS...: sweep.py, where what it needs is there and may be used.
set -eu
command -v python3 >/dev/null || { echo "skipped: no python3"; exit 77; }
PYTHONDONTWRITEBYTECODE=1 exec python3 "$(dirname "$0")/sweep.py" "$@"
