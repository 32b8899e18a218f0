#!/bin/sh
# slurm.sh INPUT FRAMES RANGES FOLDER: the same by Slurm, as three jobs, each of which waits for the one before: an array
# of pupil meter, pupil adapt, an array of pupil map. FOLDER is one that all nodes see; afterwards it has 0.mkv, 1.mkv, ...
# $PUPIL: the program; $OPTIONS: settings of pupil replay; $KIND: of the videos (mkv). Run again, it makes
# what is missing.
set -eu
input=$(realpath "$1") frames=$2 ranges=$3 folder=$4
pupil=${PUPIL:-pupil} kind=${KIND:-mkv}
mkdir -p "$folder"
folder=$(realpath "$folder")
# The range of task $i, as each task finds it.
range='i=$SLURM_ARRAY_TASK_ID; last=$((frames * (i + 1) / ranges)); [ $((i + 1)) -lt $ranges ] || last=;
range=$((frames * i / ranges))..$last'
begin="frames=$frames ranges=$ranges; $range"
array="--parsable --requeue --array=0-$((ranges - 1)) --output=$folder/slurm-%a.log"

# shellcheck disable=SC2086 # words
metered=$(sbatch $array --job-name=pupil-meter --wrap "$begin
    [ -e '$folder'/\$i.part ] || '$pupil' meter '$input' --range \$range -o '$folder'/\$i.part --threads 1 -q ${OPTIONS:-}")
adapted=$(sbatch --parsable --dependency="afterok:$metered" --job-name=pupil-adapt --output="$folder/slurm-adapt.log" \
    --wrap "'$pupil' adapt '$folder'/*.part -o '$folder/curves' -y")
# shellcheck disable=SC2086 # words
sbatch $array --dependency="afterok:$adapted" --job-name=pupil-map --wrap "$begin
    [ -e '$folder'/\$i.$kind ] || '$pupil' map '$input' --curves '$folder/curves' --range \$range -o '$folder'/\$i.$kind \
--threads 1 -q"
