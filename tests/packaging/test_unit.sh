#!/bin/sh
# packaging.unit: systemd accepts the unit, rates its protection well, and the program accepts its options.
set -u
. "$(dirname "$0")/../lib.sh"
use_pupil
needs systemd-analyze
unit=$(dirname "$(dirname "$program")")/packaging/systemd/pupil@.service
[ -e "$unit" ] || skip "no unit is built: $unit"
# as it is installed, except for the program's path
sed "s|^ExecStart=[^ ]*|ExecStart=$program|; /^Documentation=/d" "$unit" >pupil@.service
systemd-analyze verify "$room/pupil@.service" >verify 2>&1 || fail "verify: $(cat verify)"
[ ! -s verify ] || fail "verify: $(cat verify)"
# the check can fail
sed 's/^Restart=.*/Restart=somehow/' pupil@.service >bad@.service
systemd-analyze verify "$room/bad@.service" 2>&1 | grep -q somehow || fail "verify says nothing of a bad unit"

# 0 is the best, 10 no protection
if systemd-analyze security --help | grep -q -- --offline; then
    systemd-analyze security --offline=true "$room/pupil@.service" >security 2>&1 || fail "security: $(tail -n 3 security)"
    exposure=$(sed -n 's/.*Overall exposure level for [^:]*: \([0-9.]*\).*/\1/p' security)
    awk -v e="${exposure:-10}" 'BEGIN { exit !(e <= 1.5) }' || fail "systemd-analyze security: $exposure"
    echo "systemd-analyze security: $exposure"
fi

# its options, with a missing camera that has a long name
long=$room/$(printf '%0120d' 0)
mkdir "$long"
line=$(sed -n '/^ExecStart=/{N; s/\\\n//; s/^ExecStart=[^ ]* //p}' "$unit" | sed "s|/dev/%I|$room/absent|; s|\${STATE_DIRECTORY}|$room|; s|\${RUNTIME_DIRECTORY}|$long|; s| \$PUPIL_OPTIONS||")
# shellcheck disable=SC2086 # words
call 1 "$room/absent" $line
end_test
