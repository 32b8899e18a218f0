#!/bin/sh
# service_guest.sh: a service in the guest of packaging.service, with the packages installed: pupil@video0 with a USB
# camera. $camera is uvc_camera's file, $node node_command's, in this folder.
set -u
here=$(cd "$(dirname "$0")" && pwd)
camera=$here/vm_uvc_camera node=$here/vm_node
. "$here/uvc_plug.sh"
cd /run || exit 1
unit=pupil@video0.service
failures=0
fail() {
    echo "FAILED: $*"
    failures=$((failures + 1))
}
property() { systemctl show -P "$1" $unit; }
# until SECONDS WORDS COMMAND...: the command is true within that time; the processor is emulated
until_true() {
    seconds=$1 words=$2
    shift 2
    for _ in $(seq $((seconds * 2))); do
        "$@" && return 0
        sleep 0.5
    done
    fail "$words within $seconds s"
    return 1
}
is() { [ "$(property ActiveState)" = "$1" ]; }
# level LIGHT: log-average of the camera's picture, given its present controls: UVC_LIGHT at 10 ms, gain 1 and light 8
level() {
    awk -v exposure="$("$node" get "$path" "Exposure Time, Absolute")" -v gain="$("$node" get "$path" Gain)" -v light="$1" \
        'BEGIN { print 0.1 * exposure / 100 * gain / 16 * 8 ^ (light - 8) }'
}
# The camera's linear light is taken for a display's codes, and may be 2.4 stops below its key (tests/vm/uvc_guest.sh).
is_right() { awk -v level="$(level "$1")" 'BEGIN { exit !(level > 0.034 && level < 0.24) }'; }
status() { property StatusText; }
kept() { sed -n 2p /var/lib/pupil/video0/exposure; }
# begins_as_kept: the first frame of the run was taken with the kept setting, within a tenth
begins_as_kept() {
    journalctl _PID="$(property MainPID)" -o cat --no-pager | grep -m 1 '^{' >first.json
    sed 's/.*"exposure_s": *\([^,]*\),"gain": *\([^,]*\),.*/\1 \2/' first.json |
        awk -v kept="$(kept)" '{ split(kept, k); if ($1 * $2 > 0.9 * k[1] && $1 * $2 < 1.1 * k[1]) ok = 1 }
            END { exit !ok }' || fail "the first frame is not as it was kept, $(kept): $(cat first.json)"
}

# plugged in but not enabled: nothing starts
plug display
until_true 60 "no unit for the device" systemctl -q is-active dev-video0.device
sleep 3
is inactive || fail "it begins without being enabled: $(property ActiveState)"
kill -TERM $plugged
wait $plugged
until_true 60 "the device is still there" eval '! systemctl -q is-active dev-video0.device'

# enabled without a camera: nothing starts; plugged in: started once it has converged
mkdir -p /etc/pupil
echo 'PUPIL_OPTIONS=--mode sensor --width 320 --height 240 --framerate 5 --stats -' >/etc/pupil/video0.conf
systemctl -q enable $unit || fail "it cannot be enabled"
systemctl daemon-reload
is inactive || fail "it begins without a camera: $(property ActiveState)"
plug display
until_true 60 "it does not begin" eval 'is activating || is active'
until_true 180 "it has not converged: $(status)" is active || journalctl -u $unit --no-pager -n 30
echo "started: $(status); the camera's picture is at $(level 8)"
is_right 8 || fail "the camera's picture is at $(level 8)"
first=$(property MainPID)
user=$(stat -c %u "/proc/$first")
[ "${user:-0}" != 0 ] || fail "it runs as root"
echo "user $user, restarts $(property NRestarts)"
pupil ctl /run/pupil/video0/control status | grep -q '"ok":true' || fail "pupil ctl: $(pupil ctl /run/pupil/video0/control status 2>&1)"
until_true 60 "nothing is kept" test -s /var/lib/pupil/video0/exposure
kept=$(kept)
echo "kept: $kept"

# killed: it restarts by itself, with the kept setting
systemctl kill -s KILL $unit
until_true 60 "it is not begun again" eval '[ "$(property NRestarts)" = 1 ] && [ "$(property MainPID)" != 0 ]'
until_true 180 "it is not back" is active || journalctl -u $unit --no-pager -n 30
[ "$(property MainPID)" != "$first" ] || fail "it was not killed"
begins_as_kept
echo "killed, and back: $(status); restarts $(property NRestarts), the camera's picture is at $(level 8)"
is_right 8 || fail "after it was killed the camera's picture is at $(level 8)"

# other light
"$node" light $plugged 9
until_true 120 "light 9: the camera's picture is at $(level 9)" is_right 9
echo "eight times the light: the camera's picture is at $(level 9)"
"$node" light $plugged 8
until_true 120 "light 8: the camera's picture is at $(level 8)" is_right 8
sleep 5

# unplugged: it ends with its device; plugged in again with other settings, it begins with the kept setting
kill -TERM $plugged
wait $plugged
until_true 60 "unplugged: $(property ActiveState)" eval 'is inactive || is failed'
plug display
until_true 180 "plugged in again: $(property ActiveState)" is active || journalctl -u $unit --no-pager -n 30
begins_as_kept
echo "plugged in again: $(status); kept $(kept)"
systemctl stop $unit
is inactive || fail "stopped: $(property ActiveState)"
is_put_back || fail "the controls are not put back"
journalctl -u $unit --no-pager -o cat | grep -v '^{' | tail -n 15
echo "$failures failures"
echo "guest: status $failures"
