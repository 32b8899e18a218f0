#!/bin/sh
# The study at full size in the room, and with radiosity: no violation. Takes minutes.
set -u
program=${PUPIL_PROGRAM:?the pupil program}
scenes=$(dirname "$0")/../../../../fixtures/scenes
failures=0
for scene in "$scenes"/room.scene "$scenes"/room-radiosity.scene; do
    [ ! -e "$scene" ] || "$program" study "$scene" --check --quiet || failures=$((failures + 1))
done
[ "$failures" = 0 ]
