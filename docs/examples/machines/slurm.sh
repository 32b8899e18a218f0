#!/bin/sh
# slurm.sh INPUT FRAMES RANGES FOLDER: as parallel.sh, by Slurm: three jobs, each of which waits for the one before: an array
# of pupil meter, pupil adapt, an array of pupil map. FOLDER is one that all nodes see; afterwards it has 0.mkv, 1.mkv, ...
# $PUPIL: the program; $OPTIONS: settings of pupil replay; $KIND: format of the videos (mkv). Run again, it
# makes what is missing.
set -eu
[ $# = 4 ] || { echo "usage: sh slurm.sh INPUT FRAMES RANGES FOLDER" >&2; exit 2; }
input=$(realpath -- "$1") frames=$2 ranges=$3 folder=$4
pupil=${PUPIL:-pupil} kind=${KIND:-mkv} OPTIONS=${OPTIONS:-}
for number in "FRAMES $frames" "RANGES $ranges"; do
    case ${number#* } in '' | 0* | *[!0-9]*)
        echo "slurm.sh: ${number%% *} must be a positive whole number, not '${number#* }'" >&2
        exit 2 ;;
    esac
done
[ "$ranges" -le "$frames" ] || ranges=$frames # no empty ranges
mkdir -p -- "$folder"
folder=$(realpath -- "$folder")

# The folder is for these settings only.
settings="$input $(if [ -f "$input" ]; then stat -c '%s %y' "$input"; fi)
$frames frames, $ranges ranges, $kind, $OPTIONS"
if [ -n "$(ls -A "$folder")" ] && [ "$(cat "$folder/settings" 2>/dev/null)" != "$settings" ]; then
    echo "slurm.sh: $folder is of another input or other settings: remove it to begin anew" >&2
    exit 1
fi
echo "$settings" >"$folder/settings"

# Tasks get names in variables, never as part of a command's text.
export input folder frames ranges pupil kind OPTIONS
# The range of task $i, as each task finds it.
begin='i=$SLURM_ARRAY_TASK_ID; last=$((frames * (i + 1) / ranges)); [ $((i + 1)) -lt $ranges ] || last=
range=$((frames * i / ranges))..$last'
logs=$(printf '%s/slurm' "$folder" | sed 's/%/%%/g')
submit() { # NAME COMMAND OPTIONS...: the job's number
    name=$1 command=$2
    shift 2
    sbatch --export=ALL --parsable --job-name="pupil-$name" --wrap "$command" "$@"
}
array() { # NAME COMMAND OPTIONS...
    name=$1 command=$2
    shift 2
    submit "$name" "$begin
$command" --requeue --array="0-$((ranges - 1))" --output="$logs-%a.log" "$@"
}

metered=$(array meter '[ -e "$folder/$i.part" ] ||
    "$pupil" meter --range $range -o "$folder/$i.part" --threads 1 -q $OPTIONS -- "$input"')
adapted=$(submit adapt '"$pupil" adapt "$folder"/*.part -o "$folder/curves" -y' \
    --dependency="afterok:$metered" --output="$logs-adapt.log")
array map '[ -e "$folder/$i.$kind" ] ||
    "$pupil" map --curves "$folder/curves" --range $range -o "$folder/$i.$kind" --threads 1 -q -- "$input"' \
    --dependency="afterok:$adapted"
