#!/bin/sh
# Damaged frames of four decoders, a few (test_damaged_many.sh has more).
set -u
each=2
. "$(dirname "$0")/damaged_clips.sh"
