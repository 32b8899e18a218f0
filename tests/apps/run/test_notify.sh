#!/bin/sh
# A service manager is notified by pupil run (sd_notify(3)), on a camera in the process: ready once the exposure has
# converged and not before, the state, that frames arrive, and the end. Needs $PUPIL_RUN_FAKE.
set -u
. "$(dirname "$0")/../../lib.sh"
use_fake_camera
needs python3
here=$(dirname "$0")
case $here in /*) ;; *) cannot "the test is not called by its path" ;; esac

# listen NAME: a socket; its messages go to said.manager
listen() {
    rm -f said.manager
    python3 "$here/notify_listen.py" "$1" said.manager &
    running=$!
    until_true "no socket" test -e said.manager
}
# over: stops listening
over() {
    kill $running
    wait $running 2>/dev/null
    running=
}
# count LINE: how often the manager got that
count() { grep -cx -- "$1" said.manager; }
# line WORDS: the first line with these words
line() { grep -n -- "$1" said.manager | head -n 1 | cut -d: -f1; }

# 12 times the light from 1 s on: the loop searches at first, and is ready once it has converged
for name in "$room/socket" "@pupil-test-$$"; do
    listen "$name"
    NOTIFY_SOCKET=$name call 0 "" fake:real fake:flat=600 fake:light=12@1 --mode sensor -n 120 -q
    until_true "$name: the end is not said" grep -qx STOPPING=1 said.manager
    over
    [ "$(count READY=1)" = 1 ] || fail "$name: ready $(count READY=1) times: $(cat said.manager)"
    [ "$(line '^READY=1$')" -gt "$(line '^STATUS=searching')" ] || fail "$name: ready before: $(cat said.manager)"
    grep -Eqx 'STATUS=converged( \([a-z_]*\))?, [0-9.]* ms, gain [0-9.]*' said.manager || fail "$name: $(cat said.manager)"
    [ "$(count WATCHDOG=1)" = 0 ] || fail "$name: a watchdog that nobody has"
    [ "$(tail -n 1 said.manager)" = STOPPING=1 ] || fail "$name: $(tail -n 1 said.manager) is the last"
done

# a camera whose exposure never takes effect is not ready; too dark at all settings is a limit, which is ready
listen "$room/dark"
NOTIFY_SOCKET=$room/dark call 0 "" fake:real fake:flat=1 --mode sensor -n 120 -q
over
[ "$(count READY=1)" = 1 ] && grep -q '^STATUS=limited' said.manager || fail "dark: $(cat said.manager)"
listen "$room/soon"
NOTIFY_SOCKET=$room/soon call 0 "" fake:real fake:flat=600 --mode sensor -n 2 -q
over
[ "$(count READY=1)" = 0 ] || fail "ready after two frames: $(cat said.manager)"

# without a camera's controls the picture's level counts
listen "$room/digital"
NOTIFY_SOCKET=$room/digital call 0 "" fake:no-controls -n 120 -q
over
[ "$(count READY=1)" = 1 ] && grep -q '^STATUS=settled' said.manager || fail "digital: $(cat said.manager)"

# the watchdog: at most one message per half of its time, and only for this process
listen "$room/watched"
NOTIFY_SOCKET=$room/watched WATCHDOG_USEC=500000 call 0 "" fake:real -t 2 -q
over
[ "$(count WATCHDOG=1)" -ge 3 ] && [ "$(count WATCHDOG=1)" -le 10 ] ||
    fail "in 2 s the watchdog of 0.5 s was notified $(count WATCHDOG=1) times"
listen "$room/other"
NOTIFY_SOCKET=$room/other WATCHDOG_USEC=500000 WATCHDOG_PID=1 call 0 "" fake:real -n 20 -q
over
[ "$(count WATCHDOG=1)" = 0 ] || fail "another process's watchdog is notified"

# invalid sockets: a sentence, and the run continues
for name in "$room/absent" relative "@$(printf '%0120d' 0)" "$room/$(printf '%0120d' 0)"; do
    NOTIFY_SOCKET=$name call 0 "nobody is notified" fake:real -n 5 -q
    [ "$(sentences)" = 1 ] || fail "$name: $(cat said.err)"
done
# the manager is gone: the run loses nothing
python3 - <<'END'
import socket
socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM).bind("gone")
END
NOTIFY_SOCKET=$room/gone call 0 "" fake:real -n 5 -q
end_test
