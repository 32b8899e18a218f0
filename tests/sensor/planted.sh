#!/bin/sh
# planted.sh [BUILD]: plants the errors of planted.txt in lib/sensor, one at a time, and says which test finds each: the
# walk through every sequence first, then the others. BUILD (build/dev) has the sensor's tests, up to date.
set -eu
cd "$(dirname "$0")/../.."
exec python3 tests/mutants/planted.py tests/sensor/planted.txt --build "${1:-build/dev}" --extra test_sensor_exhaustive
