#!/bin/sh
# pupil replay --veil: options for the eye and the distance; the same bits with any number of threads; what is refused
# with which words. Needs $PUPIL_PROGRAM; runs in a folder of its own.
set -u
. "$(dirname "$0")/../../lib.sh"
use_pupil

walk="replay synth:walk --size 96x54 -n 3 -q -y"

# what is refused
expect 2 "--veil ear: no such file; must be eye, eye:AGE or a file of Gaussians" $walk --veil ear
expect 2 "--veil .: cannot be read: Is a directory" $walk --veil .
expect 2 "--veil eye:0: the age must be from 1 to 120 years" $walk --veil eye:0
expect 2 "--veil eye:old: the age must be from 1 to 120 years" $walk --veil eye:old
expect 2 "--veil eye:: the age" $walk --veil eye:
expect 2 "--veil" $walk --veil ""
expect 2 "--fov 151: must be degrees, from 0.1 to 150" $walk --veil eye --fov 151
expect 2 "--fov: needs --veil" $walk --fov 50
expect 2 "--veil and --fused" $walk --veil eye --fused
expect 2 "--bloom: needs --veil" $walk --bloom
expect 2 "--bloom-above: needs --bloom" $walk --veil eye --bloom-above 1
expect 2 "--bloom-above -1: must be light in the frames' unit, from 0 to" $walk --veil eye --bloom --bloom-above -1
expect 2 "--bloom and --gles: one of them" $walk --veil eye --bloom --gles
: >none
expect 2 "--veil none: has no Gaussian" $walk --veil none
printf '# a lens\n 5 0.03 # wide\n\n20\t0.02\n' >lens
printf '5 0.03\n7 x\n' >letters
expect 2 "--veil letters, line 2: must be a standard deviation in degrees and a share of the light" $walk --veil letters
printf '5 0.7\n7 0.4\n' >much
expect 2 "--veil much: gaussian: the weights must be at most 1 together" $walk --veil much
printf '500 0.1\n' >wide
expect 2 "--veil wide: gaussian: sigma must be from 1e-4 to 180 degrees" $walk --veil wide
yes '1 0.01' | head -25 >many
expect 2 "--veil many, line 25: at most 24 Gaussians" $walk --veil many
expect 2 "no such option of pupil run; it is of pupil replay" run --veil eye
# 1,236 pixels wide here, more than a bloom's lobe may be
{ printf 'PF\n16384 1\n-1.0\n' && head -c 196608 /dev/zero; } >long.pfm
printf '4.4 0.1\n' >broad
expect 1 "--bloom: lobe: sigma must be from 0.1 to 1024 pixels" replay long.pfm -q -o long.png --veil broad --bloom

# the same bits with any number of threads; each gives a picture different from the one without
expect 0 "" $walk -o without.y4m
for eye in eye eye:25 eye:70 lens; do
    expect 0 "" $walk --veil $eye --threads 1 -o one.y4m --stats one.csv
    expect 0 "" $walk --veil $eye --threads 3 -o three.y4m
    cmp -s one.y4m three.y4m || fail "--veil $eye: one thread and three differ"
    cmp -s one.y4m without.y4m && fail "--veil $eye: no veil is seen"
    cp one.y4m "veil-$eye.y4m"
done
cmp -s veil-eye:25.y4m veil-eye:70.y4m && fail "age is not seen"
expect 0 "" $walk --veil eye --fov 20 -o narrow.y4m
cmp -s narrow.y4m veil-eye.y4m && fail "--fov is not seen"

# with bloom: the same bits with any number of threads, another picture than with the veil alone
expect 0 "" $walk --veil eye --bloom --threads 1 -o one.y4m --stats one.csv
expect 0 "" $walk --veil eye --bloom --threads 3 -o three.y4m
cmp -s one.y4m three.y4m || fail "--bloom: one thread and three differ"
cmp -s one.y4m veil-eye.y4m && fail "--bloom: no bloom is seen"
expect 0 "" $walk --veil eye --bloom --bloom-above 1e9 -o above.y4m
cmp -s above.y4m veil-eye.y4m || fail "--bloom-above 1e9: there is a bloom of no light"

# the exposure is the frame's: a veil moves light, and is not metered
expect 0 "" $walk --stats without.csv
cut -d, -f2-5 without.csv >a
cut -d, -f2-5 one.csv >b
cmp -s a b || fail "a veil changes the exposure: $(diff a b | head -4)"

end_test
