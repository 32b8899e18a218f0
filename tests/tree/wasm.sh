#!/bin/sh
# wasm.sh BUILD: the preset wasm as a user would build it, and the digests of both of its levels under node.
set -eu
for tool in clang wasm-ld llvm-ar node; do
    command -v $tool >/dev/null || { echo "skipped: no $tool"; exit 77; }
done
exec sh "$(dirname "$0")/nested.sh" "$1" - "-L quick" -- --preset wasm -DPUPIL_TESTS=ON
