#!/bin/sh
# docs/examples/machines/slurm.sh on a one-node Slurm that runs only for this test, with its own key, ports and folders:
# the pictures of one pupil replay, also if a task is killed in the middle and everything is submitted again. Runs as
# root, as Slurm's daemons require. Needs $PUPIL_PROGRAM.
examples=$(cd "$(dirname "$0")/../../../docs/examples/machines" && pwd)
. "$(dirname "$0")/../../lib.sh"
use_pupil
needs ffmpeg
for tool in slurmctld slurmd munged sbatch; do
    PATH=$PATH:/usr/sbin command -v $tool >/dev/null || skip "no $tool: the packages are listed in test.sh"
done
PATH=$PATH:/usr/sbin
[ "$(id -u)" = 0 ] || cannot "not root"

node=$(hostname)
mkdir state spool munge
chmod 700 munge
dd if=/dev/urandom of=munge/key bs=1 count=128 2>/dev/null
chmod 400 munge/key
cat >slurm.conf <<END
ClusterName=test
SlurmctldHost=$node(127.0.0.1)
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket=$room/munge/socket
SlurmctldPort=16817
SlurmdPort=16818
StateSaveLocation=$room/state
SlurmdSpoolDir=$room/spool
SlurmctldPidFile=$room/slurmctld.pid
SlurmdPidFile=$room/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
ReturnToService=2
MailProg=/bin/true
NodeName=$node NodeAddr=127.0.0.1 CPUs=2 State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES State=UP
END
export SLURM_CONF="$room/slurm.conf"
munged --force -F -S munge/socket --key-file="$room/munge/key" --pid-file="$room/munge/pid" --seed-file="$room/munge/seed" \
    --log-file="$room/munge/log" >/dev/null 2>&1 &
running="$running $!"
sleep 1
slurmctld -D -f slurm.conf >slurmctld.log 2>&1 &
running="$running $!"
slurmd -D -f slurm.conf -N "$node" >slurmd.log 2>&1 &
running="$running $!"
tries=0
until sinfo -h -o %T 2>/dev/null | grep -q idle; do
    tries=$((tries + 1))
    [ $tries -lt 60 ] || cannot "Slurm does not start here: $(tail -n 2 slurmctld.log slurmd.log)"
    sleep 0.5
done

# wait_for JOB: until it has left the queue
wait_for() {
    tries=0
    while [ -n "$(squeue -h -j "$1" 2>/dev/null)" ]; do
        tries=$((tries + 1))
        [ $tries -lt 240 ] || { fail "job $1 does not end: $(squeue)" && return; }
        sleep 0.5
    done
}
frames() {
    for one in "$@"; do
        tail -n +2 "$one"
    done | sha256sum
}

ffmpeg -loglevel error -f lavfi -i "testsrc2=size=96x54:rate=30:duration=10,hue=s=0.2,
    eq=contrast=0.6:brightness='if(lt(mod(t,2),1),0.2,0.02)':eval=frame" -pix_fmt yuv420p -c:v ffv1 "it's; 100%.mkv"
call 0 "" replay "it's; 100%.mkv" -o whole.y4m -q
export PUPIL="$program" KIND=y4m
wait_for "$(sh "$examples/slurm.sh" "it's; 100%.mkv" 300 7 "shown '1%'")"
[ "$(frames "shown '1%'"/?.y4m)" = "$(frames whole.y4m)" ] || fail "other pictures: $(cat "shown '1%'"/slurm-*.log)"
sh "$examples/slurm.sh" "it's; 100%.mkv" 300 6 "shown '1%'" >said 2>&1 && fail "other ranges: not refused"
grep -q "is of another input or other settings" said || fail "other ranges: $(cat said)"
sh "$examples/slurm.sh" "it's; 100%.mkv" 300 -1 bad >said 2>&1 && fail "-1 ranges: not refused"
grep -q "RANGES must be" said || fail "-1 ranges: $(cat said)"

# A killed task leaves nothing unfinished; jobs that depend on it never start, and the next submission continues.
cat >once <<END
#!/bin/sh
[ -e "$room/killed" ] || case "\$*" in *" meter "*|"meter "*100..*)
    : >"$room/killed"
    "$program" "\$@" &
    kill -9 \$!
    wait \$!
    exit ;;
esac
exec "$program" "\$@"
END
chmod +x once
PUPIL="$room/once"
job=$(sh "$examples/slurm.sh" "it's; 100%.mkv" 300 6 again)
tries=0
until [ -e killed ] || [ $tries -ge 120 ]; do
    tries=$((tries + 1))
    sleep 0.5
done
sleep 3
[ ! -e again/curves ] || fail "adapted without the part of a task that was killed"
scancel -u root
wait_for "$(sh "$examples/slurm.sh" "it's; 100%.mkv" 300 6 again)"
[ "$(frames again/?.y4m)" = "$(frames whole.y4m)" ] || fail "killed: other pictures: $(cat again/slurm-*.log)"
[ -e killed ] || fail "no task was killed"
end_test
