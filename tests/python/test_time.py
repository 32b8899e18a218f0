"""The time of process() at 1920 x 1080 over that of the C function with the same memory, in turns in one process."""
import ctypes
import time

import numpy as np

import check
import pupil_ae
from pupil_ae._library import lib

frame = np.exp2(np.random.default_rng(22).uniform(-6, 4, (1080, 1920, 3))).astype(np.float32)
out = np.empty((1080, 1920, 3), np.uint8)
pupil = pupil_ae.Pupil()
source = pupil_ae._image.view(frame)
_, target = pupil_ae._image.out_view(source, out, None, False)
info = pupil_ae._settings.frame_info(0, 0, 0.0, 0.0)
arguments = [ctypes.byref(thing) for thing in (pupil._pupil, source.image, info, target.image)]


def in_c():
    lib.pupil_process(*arguments)


def in_python():
    pupil.process(frame, out=out)


def allocating():
    pupil.process(frame)


def deeper(call, depth):
    """The call, so many of C's frames further down the stack: where its buffers are there changes the time by up to a
    tenth, and process() calls from further down."""
    if depth:
        list(map(lambda _: deeper(call, depth - 1), (0,)))
    else:
        call()


def seconds(call, depth=0):
    """Of this thread on its processor: what else runs on the machine shows less."""
    begin = time.thread_time()
    deeper(call, depth)
    return time.thread_time() - begin


# The least of each: what disturbs only adds. More turns where the machine is busy.
least = {in_c: float("inf"), in_python: float("inf"), allocating: float("inf")}
for turn in range(120):
    for call in (in_c, in_python, allocating) if turn % 2 else (allocating, in_python, in_c):
        least[call] = min(least[call], seconds(call, turn // 2 % 8))
    ratio = least[in_python] / least[in_c]
    if turn >= 39 and ratio <= 1.02:
        break
small = np.zeros((2, 2, 3), np.float32)
tiny = np.empty((2, 2, 3), np.uint8)
each = min(seconds(lambda: [pupil.process(small, out=tiny) for _ in range(100)]) for _ in range(5)) / 100
print(f"process() takes {ratio:.4f} times as long as the C function's {1e3 * least[in_c]:.2f} ms, "
      f"{least[allocating] / least[in_c]:.4f} with a new array for each picture; of 2 x 2 pixels {1e6 * each:.0f} us")
check.that(ratio <= 1.02, f"{ratio:.4f} is more than 1.02")
check.end()
