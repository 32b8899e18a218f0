#!/usr/bin/env python3
"""opencv_video INPUT OUTPUT.avi: what cv2.VideoCapture reads (a camera's number, a video, shot%03d.png), well exposed.

    apt-get install python3-numpy python3-opencv      # and pupil: docs/guide.md, Building
    python3 opencv_video.py 0 out.avi

VideoCapture reports neither frame numbers nor the exposure time and gain of a frame. To control a camera's exposure use
`pupil run`, or the library pupil-camera, on the same node."""
import sys

import cv2
import numpy as np
import pupil_ae

if len(sys.argv) != 3:
    sys.exit(__doc__)
# For a camera OpenCV would use GStreamer, whose frames have no timestamps.
capture = cv2.VideoCapture(int(sys.argv[1]), cv2.CAP_V4L2) if sys.argv[1].isdigit() else cv2.VideoCapture(sys.argv[1])
pupil, picture, writer, count = pupil_ae.Pupil(), None, None, 0
while count < 3000:
    taken, frame = capture.read()  # uint8, blue first
    if not taken:
        break
    if writer is None:
        rate = capture.get(cv2.CAP_PROP_FPS) or 30
        writer = cv2.VideoWriter(sys.argv[2], cv2.VideoWriter_fourcc(*"MJPG"), rate, frame.shape[1::-1])
        picture = np.empty_like(frame)
    position_ms = capture.get(cv2.CAP_PROP_POS_MSEC)  # a file's own time, or V4L2's; undefined for stills
    time_ns = int(position_ms * 1e6) if 0 < position_ms < 1e12 else 0  # 0: frames are 1/30 s apart
    pupil.process(frame, pixel="BGR8", out=picture, timestamp_ns=time_ns)
    writer.write(picture)
    count += 1
if writer is None:
    sys.exit(f"opencv_video: {sys.argv[1]} has no frames")
writer.release()
print(f"{count} frames, the last one adapted to {pupil.exposure.adapted_ev:+.2f} EV")
