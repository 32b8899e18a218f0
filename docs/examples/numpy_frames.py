#!/usr/bin/env python3
"""numpy_frames: a scene whose light rises eightfold, as float arrays of numpy, mapped frame by frame.

    apt-get install python3-numpy      # and pupil: docs/guide.md, Building
    python3 numpy_frames.py"""
import numpy as np
import pupil_ae

HEIGHT, WIDTH = 270, 480
rows, columns = np.mgrid[0:HEIGHT, 0:WIDTH].astype(np.float32)
scene = np.exp2(columns / WIDTH * 8 - 6)[..., None] * np.array([1.0, 0.8, 0.6], np.float32)  # 8 stops of linear light

pupil = pupil_ae.Pupil(tau_light_s=0.3)
picture = np.empty((HEIGHT, WIDTH, 3), np.uint8)  # one for all frames: a new one each time costs page faults
for number in range(90):
    light = 1.0 if number < 30 else 8.0
    pupil.process(scene * np.float32(light), out=picture, timestamp_ns=number * 33_333_333)
    if number % 15 == 14:
        exposure = pupil.exposure
        print(f"frame {number}: metered {exposure.metered_ev:+.2f} EV, adapted {exposure.adapted_ev:+.2f} EV, "
              f"{exposure.state.name.lower()}, middle {picture[HEIGHT // 2, WIDTH // 2]}")

upside_down = pupil.process(scene[::-1])  # a view costs no copy
floats = pupil.process(scene, out_pixel="RGB32F")  # linear display light, 0..1
print(upside_down.shape, upside_down.dtype, floats.shape, floats.dtype, f"{floats.min():.3f} to {floats.max():.3f}")
