"""docs/examples/opencv_video.py on a video that OpenCV wrote: frames of light that doubles."""
import os
import pathlib
import re
import subprocess
import sys
import tempfile

import check

try:
    import cv2
except ImportError:
    print("skipped: no python3-opencv")
    sys.exit(77)
import numpy as np
import pupil_ae

SCRIPT = pathlib.Path(os.environ["PUPIL_SOURCE_DIR"]) / "docs" / "examples" / "opencv_video.py"


def run(*arguments):
    return subprocess.run([sys.executable, SCRIPT, *map(str, arguments)], text=True, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT)


with tempfile.TemporaryDirectory() as folder:
    source, result = pathlib.Path(folder, "in.avi"), pathlib.Path(folder, "out.avi")
    writer = cv2.VideoWriter(str(source), cv2.VideoWriter_fourcc(*"MJPG"), 25, (64, 48))
    for number in range(50):
        writer.write(np.full((48, 64, 3), 60 if number < 25 else 120, np.uint8))
    writer.release()
    ended = run(source, result)
    check.that(ended.returncode == 0 and "50 frames" in ended.stdout, ended.stdout)
    # sRGB 120 is 0.1878 of light, -2.41 EV; a second after the change less than a tenth of it is left
    adapted = float(re.search(r"adapted to ([-+.\d]+) EV", ended.stdout).group(1))
    check.that(abs(adapted - -2.41) < 0.25, ended.stdout)
    capture = cv2.VideoCapture(str(result))
    check.that(int(capture.get(cv2.CAP_PROP_FRAME_COUNT)) == 50, "frames in the result")
    still = pathlib.Path(folder, "still.png")
    cv2.imwrite(str(still), np.full((48, 64, 3), 60, np.uint8))
    ended = run(still, result)  # its position is a meaningless number
    check.that(ended.returncode == 0 and "1 frames" in ended.stdout, ended.stdout)
    check.that("no frames" in run(pathlib.Path(folder, "none.avi"), result).stdout, "a file that is not there")
    check.that(run().returncode == 1 and "opencv_video INPUT" in run().stdout, "no arguments")

# cv2's memory in any shape gives the same picture, and a UMat is refused with advice.
frame = np.random.default_rng(25).integers(0, 256, (48, 64, 3), dtype=np.uint8)
wanted = pupil_ae.Pupil().process(frame, pixel="BGR8")
yuv = cv2.cvtColor(frame, cv2.COLOR_BGR2YUV_I420)
check.that(pupil_ae.Pupil().process(yuv, pixel="I420").shape == (48, 64, 3), "I420 of cvtColor")
check.that(np.array_equal(pupil_ae.Pupil().process(cv2.UMat(frame).get(), pixel="BGR8"), wanted), "UMat.get()")
check.raises(TypeError, "cv2.UMat use .get()", pupil_ae.Pupil().process, cv2.UMat(frame))
red_first = cv2.cvtColor(frame, cv2.COLOR_BGR2RGB)
check.that(np.array_equal(pupil_ae.Pupil().process(red_first)[:, :, ::-1], wanted), "order")
check.end()
