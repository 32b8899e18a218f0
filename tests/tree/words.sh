#!/bin/sh
# words.sh: no paths of a machine in any file; no retired words (docs/glossary.md) in help, messages, public headers and
# documents; documents name only files and functions that are there.
# words.sh --figures [--root TREE]: how long the sentences are, room by room, and how many of them have retired words.
cd "$(dirname "$0")/../.." || exit 1
command -v python3 >/dev/null || { echo "skipped: no python3"; exit 77; }
exec python3 tests/tree/words.py "$@"
