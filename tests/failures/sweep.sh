#!/bin/sh
# sweep.sh ARGUMENTS...: sweep.py, if its requirements are installed and permitted.
set -eu
command -v python3 >/dev/null || { echo "skipped: no python3"; exit 77; }
PYTHONDONTWRITEBYTECODE=1 exec python3 "$(dirname "$0")/sweep.py" "$@"
