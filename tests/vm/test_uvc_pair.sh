#!/bin/sh
# vm.uvc_pair: test_uvc_pair.sh CAMERA NODE: boots the guest and runs two USB cameras there with one exposure, through
# two steps of light of three stops. The shown level (exposure time x gain x the factor of the picture) has to be the
# same within 0.05 EV, one stop less for the second camera, in all frames. One in ten may differ: a busy emulated
# processor takes frames late, and then the second camera does not wait. Each frame is compared with the other camera's
# nearest one in time.
set -eu
. "$(dirname "$0")/amd64.sh"
log=$(mktemp)
trap 'rm -f "$log"' EXIT
status=0
in_guest "$here/uvc_pair_guest.sh" "$@" "$PUPIL_PROGRAM" >"$log" || status=$?
sed '/^figures/,/^end of figures/d' "$log"
[ $status = 0 ] || exit $status
python3 - "$log" <<'END'
import csv, math, re, sys

text = open(sys.argv[1]).read()
rows = [list(csv.DictReader(part.strip().splitlines()))
        for part in re.findall(r"^figures \d\n(.*?)^end of figures", text, re.S | re.M)]
assert len(rows) == 2 and all(len(r) > 40 for r in rows), [len(r) for r in rows]
MOST_LATE = 8

def shown(row):
    return math.log2(float(row["exposure_s"]) * float(row["gain"]) * float(row["digital"]))

def steps(of):  # the frames with which the light changes, by the light of the scene; not while the cameras are learned
    ev, at = [float(r["scene_ev"]) for r in of], [float(r["time_s"]) for r in of]
    found = []
    for n in range(1, len(ev) - 1):
        if at[n] > 6 and abs(ev[n] - ev[n - 1]) > 1.2 and (not found or at[n] - at[found[-1]] > 9):
            found.append(n)
    return found

first, second = steps(rows[0]), steps(rows[1])
print("the light changes in frames", first, "and", second)
assert len(first) == 2 and len(second) == 2
time = [[float(r["time_s"]) for r in of] for of in rows]
ahead = time[1][second[0]] - time[0][first[0]]  # of the second camera's clock, which begins with its first frame
same, worst, apart = 0, 0.0, []
for n in range(first[0] - 8, len(rows[0]) - 2):
    m = min(range(len(rows[1])), key=lambda k: abs(time[1][k] - ahead - time[0][n]))
    by = abs(shown(rows[0][n]) - shown(rows[1][m]) - 1.0)
    if by <= 0.05:
        same, worst = same + 1, max(worst, by)
    else:
        apart.append((round(min((time[0][n] - time[0][at] for at in first if n >= at), default=-1.0), 1), round(by, 3)))
print(f"{same} frames: one exposure within {worst:.3f} EV; others, by seconds since a step and EV: {apart}")
levels = [float(of[-3]["output_level"]) for of in rows]
print("shown at the end at %.3f and %.3f" % tuple(levels))
assert same > 40 and len(apart) <= same / 10
assert abs(math.log2(levels[0] / levels[1])) < 0.1 and levels[0] > 0.05
assert rows[0][-3]["sensor"] == "converged" and rows[1][len(rows[1]) // 2]["sensor"] == "following"
END
