#!/bin/sh
# Damaged frames of four decoders: 52 clips.
set -u
each=13
. "$(dirname "$0")/damaged_clips.sh"
