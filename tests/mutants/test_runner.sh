#!/bin/sh
# test_runner.sh: the runner of mutants, with a small C file for which the verdict of each mutation is known.
set -eu
cd "$(dirname "$0")"
command -v python3 >/dev/null || { echo "skipped: no python3"; exit 77; }
PYTHONDONTWRITEBYTECODE=1 exec python3 test_runner.py
