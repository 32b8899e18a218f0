"""Each format, mapped by the module and by a program in C: the same bits, also of the reported values."""
import ctypes
import os
import subprocess

import numpy as np

import check
import pupil_ae
from pupil_ae import Pixel, _abi, _image
from pupil_ae._settings import struct_of

C_PROCESS = os.environ["PUPIL_C_PROCESS"]
OUTS = [Pixel[name] for name in "RGBA8 RGB8 BGRX8 BGR8 NV12 I420 RGBA32F RGB32F BGR32F RGBA16F RGB16F".split()]
random = np.random.default_rng(19)


def shape_of(pixel, width, height):
    """As in the module's documentation."""
    if pixel in _image.CHANNELS:
        return height, width, _image.CHANNELS[pixel]
    if pixel in _image.PAIRED:
        return height, width, 2
    if pixel in _image.PACKED:
        return height, width * _image.PACKED[pixel][1] // _image.PACKED[pixel][0]
    if pixel == Pixel.I444_16:
        return 3, height, width
    if pixel == Pixel.NV16:
        return 2 * height, width
    if pixel in (Pixel.NV12, Pixel.NV21, Pixel.I420, Pixel.P010, Pixel.I420_10):
        return height * 3 // 2, width
    return height, width


def samples(pixel, shape):
    """Light over many stops; random bits if samples are codes."""
    dtype = _image.SAMPLE[pixel]
    if dtype.kind == "f":
        return np.exp2(random.uniform(-9, 4, shape)).astype(dtype)
    top = {"10": 1 << 10, "12": 1 << 12, "14": 1 << 14}.get(pixel.name.replace("I420_10", "10")[-2:])
    top = None if pixel == Pixel.P010 or dtype.itemsize == 1 else top
    return random.integers(0, top or 1 << 8 * dtype.itemsize, shape, dtype=dtype)


def through_c(pixel, out_pixel, frames, width, height, half):
    arguments = [C_PROCESS, pixel, width, height, out_pixel, width // half, height // half]
    made = subprocess.run([str(int(a)) if a != C_PROCESS else a for a in arguments], stdout=subprocess.PIPE, check=True,
                          input=b"".join(frame.tobytes() for frame in frames)).stdout
    tail = ctypes.sizeof(_abi.pupil_exposure) + ctypes.sizeof(_abi.pupil_stats) + ctypes.sizeof(_abi.pupil_curve)
    return made[:-tail], made[-tail:]


def through_python(pixel, out_pixel, frames, half):
    pupil = pupil_ae.Pupil()
    pictures = [pupil.process(frame, pixel=pixel, out_pixel=out_pixel, half=half == 2, timestamp_ns=i * 16666667,
                              sequence=i, exposure_s=0.005, gain=2) for i, frame in enumerate(frames, 1)]
    exposure, curve = pupil.exposure, pupil.curve()
    said = bytes(_abi.pupil_exposure(ctypes.sizeof(_abi.pupil_exposure), 0, *exposure)) + bytes(pupil.stats._struct)
    return pictures, said + bytes(struct_of(_abi.pupil_curve, curve))


def compare(pixel, out_pixel, half=1):
    width, height = 64, 36
    frames = [samples(pixel, shape_of(pixel, width, height)) for _ in range(3)]
    wanted, said = through_c(pixel, out_pixel, frames, width, height, half)
    pictures, reported = through_python(pixel, out_pixel, frames, half)
    what = f"{pixel.name} to {out_pixel.name}"
    check.that(b"".join(picture.tobytes() for picture in pictures) == wanted, f"{what}: the pictures differ")
    check.that(reported == said, f"{what}: exposure, statistics or curve differ")
    check.that(pictures[0].shape == shape_of(out_pixel, width // half, height // half), f"{what}: {pictures[0].shape}")


for number, pixel in enumerate(p for p in Pixel if p):
    for out_pixel in (OUTS[number % len(OUTS)], Pixel.RGB8):
        compare(pixel, out_pixel)
for out_pixel in OUTS:
    compare(Pixel.RGB32F, out_pixel)
compare(Pixel.BAYER12P, Pixel.NV12, half=2)
check.end()
