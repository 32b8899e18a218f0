#!/bin/sh
# check_tables.sh: lib/kernels/tables.c and tables_hdr.c are what their script prints.
set -eu
cd "$(dirname "$0")/../.."
command -v python3 >/dev/null || { echo "skipped: no python3"; exit 77; }
python3 lib/kernels/make_tables.py | cmp - lib/kernels/tables.c
python3 lib/kernels/make_tables.py hdr | cmp - lib/kernels/tables_hdr.c
