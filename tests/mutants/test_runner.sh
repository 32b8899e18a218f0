#!/bin/sh
# test_runner.sh: the runner of mutants, with a small C file of which it is known what becomes of each mutation.
set -eu
cd "$(dirname "$0")"
command -v python3 >/dev/null || { echo "skipped: no python3"; exit 77; }
PYTHONDONTWRITEBYTECODE=1 exec python3 test_runner.py
