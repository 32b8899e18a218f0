#!/bin/sh
# pupil run --control and pupil ctl, on a camera in the process (whose queue lasts 1.6 s): what can be changed without a
# lost frame; and hostile clients: long lines, partial lines, floods, many clients, and other users.
set -u
. "$(dirname "$0")/../../lib.sh"
use_fake_camera
needs python3
fake=$program
pupil=${PUPIL_PROGRAM:?the pupil program}

fakes=
# begin ARGUMENTS...: a run in the background, with a socket that answers
begin() {
    rm -f s.csv
    # shellcheck disable=SC2086 # words
    "$fake" fake:real fake:fps=10 fake:size=64x48 $fakes --buffers 16 -q --control run.sock --stats s.csv -y "$@" >run.out 2>run.err &
    running=$!
    until_true "no socket: $(cat run.err)" test -S run.sock
    until_true "no frame" eval '"$pupil" ctl run.sock status | grep -q "\"frames\":[1-9]"'
}
# over: the run ends by Ctrl-C, with all frames
over() {
    kill -INT $running
    wait $running || fail "the run: $(cat run.err)"
    running=
    [ ! -e run.sock ] || fail "the socket is left"
    python3 - <<'END' || fail "frames were lost: $(cat run.err)"
import csv
rows = list(csv.DictReader(open("s.csv")))
assert rows and all(int(r["lost"]) == 0 and int(r["late"]) == 0 for r in rows), len(rows)
END
}
# said WORDS ARGUMENTS...: words in the answer of ctl, exit 0; says: exit 1
said() { words=$1; shift; "$pupil" ctl run.sock "$@" >ctl.out 2>ctl.err && grep -qF -- "$words" ctl.out || fail "ctl $*: $(cat ctl.out ctl.err)"; }
says() { words=$1; shift; "$pupil" ctl run.sock "$@" >ctl.out 2>ctl.err && fail "ctl $* is taken"; grep -qF -- "$words" ctl.out ctl.err || fail "ctl $*: $(cat ctl.out ctl.err)"; }
# is FIELD VALUE: a field of the status
is() { "$pupil" ctl run.sock status | python3 -c "
import json, sys
got = json.loads(sys.stdin.readline())['$1']
assert got == $2 or (isinstance(got, float) and abs(got / ($2 or 1) - 1) < 1e-6), got" || fail "$1 is not $2"; }

begin -d 0 --mode both
[ "$(stat -c %a run.sock)" = 600 ] || fail "the socket's mode is $(stat -c %a run.sock)"
said '"set":"ev","value":"-0.5","from_frame":' ev -0.5
is ev -0.5
said '"ok":true' key 0.3
is key 0.3
said '"ok":true' roi 0.25,0.25,0.5,0.5
is metering '"roi 0.25,0.25,0.5,0.5"'
said '"ok":true' metering spot
said '"ok":true' roi off
is metering '"uniform"'
said '"ok":true' trim 5,95
said '"ok":true' tau-light 0.1
is tau_light 0.1
said '"ok":true' gain-max 4
is gain_max 4
said '"ok":true' shutter-max 10ms
is shutter_max 0.01
said '"ok":true' lock on
is lock True
says 'lock maybe: must be on or off' lock maybe
says '--ev 17: must be stops, from -16 to 16' ev 17
says '--roi 1,1,1: must be X,Y,WIDTH,HEIGHT' roi 1,1,1
says 'gain-max: this camera has gains from' gain-max 0.01
says 'moon: no such command; there are ev, key' moon 3
says 'out: no such command' out x.mp4
is ev -0.5
printf 'status\nev 0.25\n\nbad\nlock off\n' | "$pupil" ctl run.sock >many.out 2>ctl.err
[ "$(wc -l <many.out) $(grep -c '"ok":true' many.out)" = "4 3" ] || fail "lines of standard input: $(cat many.out ctl.err)"
python3 -c 'import json; [json.loads(l) for l in open("many.out")]' || fail "no JSON: $(cat many.out)"

# lines that are blank, too long, end with a carriage return, or contain a byte 0
python3 -c 'print("#" + "x" * 1022 + "lock on")' | "$pupil" ctl run.sock >many.out 2>ctl.err
[ "$(wc -l <many.out) $(grep -c "over 511 bytes" many.out)" = "1 1" ] || fail "a long line: $(cat many.out ctl.err)"
is lock False
printf 'ev 1\r\n\r\n \t\nlock on\r\nlock off' | "$pupil" ctl run.sock >many.out 2>ctl.err || fail "blank lines: $(cat ctl.err)"
[ "$(grep -c '"ok":true' many.out)" = 3 ] || fail "blank lines: $(cat many.out ctl.err)"
printf 'ev 2\0\n\0\n' | "$pupil" ctl run.sock >many.out 2>ctl.err
[ "$(grep -c "a byte of 0" many.out)" = 2 ] || fail "bytes of 0: $(cat many.out ctl.err)"
is ev 1
for empty in "" " "; do
    got=0
    "$pupil" ctl run.sock "$empty" >ctl.out 2>ctl.err || got=$?
    [ $got = 2 ] && grep -q "an empty command" ctl.err || fail "an empty command: exit $got: $(cat ctl.out ctl.err)"
done
said '"ok":true' "status "
said '"ok":true' " ev  0.25 "
says 'status takes nothing' status now
"$pupil" ctl run.sock --help | grep -q "lock on|off" || fail "ctl PATH --help"
"$pupil" ctl "" status 2>ctl.err && fail "a socket without a name"
grep -q "name the socket of a run" ctl.err || fail "a socket without a name: $(cat ctl.err)"
"$pupil" ctl . status 2>ctl.err && fail "a folder is not a socket"
grep -qF ".: is not a socket" ctl.err || fail "a folder: $(cat ctl.err)"

# another run does not take the socket, and the first one keeps it
call 2 "one of them" --shutter 10ms --shutter-max 10ms
call 1 "run.sock: another run is listening there" --control run.sock -n 1 -d 0
echo mine >file
call 1 "file: is there already, and no socket" --control file -n 1 -d 0
[ "$(cat file)" = mine ] || fail "a file was replaced by a socket"
call 1 "must be a path of at most 107 bytes" --control "$(printf '%0120d' 0)" -n 1 -d 0
call 1 "no socket can be made there" --control no/such/run.sock -n 1 -d 0
is ev 0.25

# announced changes
said '"set":"light","value":"+1,5"' light +1,5
said '"ok":true' filter -0.5
says "must be stops from -32 to 32" light ""
for wrong in 33 nan x 1, 1,0 1,1001 1,5x; do
    says "light $wrong: must be stops from -32 to 32, and after a comma frames from 1 to 1000" light $wrong
done
said '"ok":true' day-night -2,0,5
says "day-night 1,0,5: must be two EV of scene light" day-night 1,0,5
"$pupil" ctl run.sock status | grep -q '"day_night":"' || fail "no day_night"
said '"ok":true' day-night off
said '"ok":true' lock on
until_true "the lock" eval '"$pupil" ctl run.sock status | grep -q "\"state\":\"locked\""'
says "light: the setting is locked" light +1
over

# hostile clients, while frames come
begin -d 0 --mode both
python3 - <<'END' || fail "hostile clients: $(cat run.err)"
import json, random, socket, time

def reach():
    s = socket.socket(socket.AF_UNIX)
    s.settimeout(20)
    s.connect("run.sock")
    return s

def line(s):
    got = b""
    while not got.endswith(b"\n"):
        more = s.recv(1)
        assert more, "closed"
        got += more
    return json.loads(got)

good = reach()
def status():
    good.sendall(b"status\n")
    return line(good)
assert status()["ok"]

long = reach()  # a line of a megabyte is refused once, and the next line is taken
long.sendall(b"ev " + b"1" * (1 << 20) + b"\nstatus\n")
assert "over 511" in line(long)["error"] and line(long)["ok"]
long.sendall(b"x" * 511 + b"\n" + b"y" * 512 + b"\nstatus\n")
assert "no such command" in line(long)["error"]
assert "over 511" in line(long)["error"] and line(long)["ok"]
long.sendall(b"status\0ev 3\nstatus\r\n\n\n \n")
assert "byte of 0" in line(long)["error"] and line(long)["ok"] and not line(long)["ok"]

half = reach()  # half a line stays half a line, and one at the end of all is none
half.sendall(b"ev 1")
time.sleep(0.3)
assert status()["ev"] == 0
half.sendall(b".5\nev 2")
assert line(half)["ok"] and status()["ev"] == 1.5
half.close()
time.sleep(0.2)
assert status()["ev"] == 1.5

random.seed(1)  # any bytes
noise = reach()
noise.sendall(bytes(random.randrange(256) for _ in range(1 << 16)) + b"\n")
noise.close()

flood = reach()  # who does not read its answers is not read from, and frames go on
flood.setblocking(False)
sent = 0
before = status()["frames"]
for _ in range(40):
    try:
        sent += flood.send(b"status\n" * 4096)
    except BlockingIOError:
        time.sleep(0.05)
after = status()["frames"]
assert after > before + 5, (before, after)

others = [reach() for _ in range(12)]  # more than there may be
time.sleep(0.5)
refused = 0
for s in others:
    s.setblocking(False)
    try:
        refused += b"8 clients" in s.recv(200)
    except BlockingIOError:
        pass
assert refused >= 6, refused
assert status()["ok"]
for s in others + [flood, long]:
    s.close()
time.sleep(0.3)
again = reach()
again.sendall(b"status\n")
assert line(again)["ok"]
END
if [ "$(id -u)" = 0 ] && command -v setpriv >/dev/null; then # another user
    chmod 755 .
    cp "$pupil" ./pupil
    other="setpriv --reuid=65534 --regid=65534 --clear-groups"
    $other ./pupil ctl run.sock status >ctl.out 2>ctl.err && fail "another user is answered"
    grep -q "Permission denied" ctl.err || fail "another user: $(cat ctl.err)"
    chmod 666 run.sock # though it was opened to all users
    $other ./pupil ctl run.sock lock on >ctl.out 2>ctl.err && fail "another user is obeyed"
    grep -q "this run is another user's" ctl.out || fail "another user: $(cat ctl.out ctl.err)"
    is lock False
fi
over

# limits set in a running stream and on the command line; it is dark, so the camera goes up to them
fakes=fake:light=0.01@5
begin -d 0 --mode sensor
fakes=
until_true "the gain stays low" eval '"$pupil" ctl run.sock status | python3 -c "
import json, sys
assert json.loads(sys.stdin.readline())[\"gain\"] > 2.5" 2>/dev/null'
said '"ok":true' gain-max 2
said '"ok":true' shutter-max 5ms
until_true "the limits do not act" eval '"$pupil" ctl run.sock status | python3 -c "
import json, sys
s = json.loads(sys.stdin.readline())
assert s[\"gain\"] <= 2.01 and s[\"exposure_s\"] <= 0.00501, s" 2>/dev/null'
said '"ok":true' gain-max off
until_true "the limit stays" eval '"$pupil" ctl run.sock status | python3 -c "
import json, sys
assert json.loads(sys.stdin.readline())[\"gain\"] > 2.5" 2>/dev/null'
over

# a run that hangs, with a full queue of waiting clients
python3 - <<'END' &
import socket, time
s = socket.socket(socket.AF_UNIX)
s.bind("full.sock")
s.listen(0)
waits = socket.socket(socket.AF_UNIX)
waits.connect("full.sock")
open("full", "w").close()
time.sleep(60)
END
running=$!
until_true "no listener" test -e full
got=0
timeout 30 "$pupil" ctl full.sock status >ctl.out 2>ctl.err || got=$?
[ $got = 1 ] && grep -q "takes nobody for 10 s" ctl.err || fail "a full queue: exit $got: $(cat ctl.out ctl.err)"
kill -9 $running
wait $running 2>/dev/null
running=

# in the service's folder for the longest camera name, which exceeds the limit of a socket's path
long=$PWD/run/pupil/$(printf 'v4l-by\\x2dpath-platform\\x2dfd500000.pcie\\x2dpci\\x2d0000:01:00.0\\x2dusb\\x2d0:1.3.4.4:1.0\\x2dvideo\\x2dindex0')
mkdir -p "$long"
for round in killed over; do
    "$fake" fake:real fake:fps=10 fake:size=64x48 -d 0 -q --control "$long/control" >run.out 2>run.err &
    running=$!
    until_true "a long path: no answer: $(cat run.err)" eval '"$pupil" ctl "$long/control" status >ctl.out 2>&1'
    [ $round = over ] || kill -9 $running
    [ $round = killed ] || kill -INT $running
    wait $running 2>/dev/null
    running=
done
[ ! -e "$long/control" ] || fail "a long path: the socket is left"
"$pupil" ctl "$long/none/control" status 2>ctl.err && fail "no folder"
grep -q "its folder: No such file" ctl.err || fail "no folder: $(cat ctl.err)"

# killed: the next run takes over the leftover socket
begin -d 0
kill -9 $running
wait $running 2>/dev/null
[ -S run.sock ] || fail "there is no socket left to be replaced"
begin -d 0
over
"$pupil" ctl run.sock status >ctl.out 2>ctl.err && fail "a run that is over answers"
grep -q "run.sock: no run is reached there" ctl.err || fail "a run that is over: $(cat ctl.err)"
"$pupil" ctl >ctl.out 2>ctl.err
[ $? = 2 ] || fail "ctl without a socket"
"$pupil" ctl --help | grep -q "lock on|off" || fail "ctl --help"

end_test
