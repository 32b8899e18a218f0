"""Typical arrays: the right picture, or an error that says what would be right."""
import pickle
import tempfile

import numpy as np

import check
import pupil_ae

random = np.random.default_rng(20)
light = np.exp2(random.uniform(-6, 4, (40, 60, 3))).astype(np.float32)
codes = random.integers(0, 256, (40, 60, 3), dtype=np.uint8)


def picture_of(frame, **keywords):
    return pupil_ae.Pupil().process(frame, **keywords)


def same(frame, plain, what, **keywords):
    """The picture of an odd array is that of a plain one with the same values."""
    check.that(np.array_equal(picture_of(frame, **keywords), picture_of(plain, **keywords)), what)


# --- inputs ---
large = np.zeros((200, 300, 3), np.float32)
large[33:73, 111:171] = light
same(large[33:73, 111:171], light, "a region")
for array, what in ((large[33:73, 111:171], "a region"), (light[::-1], "upside down"), (light[::3], "each third row"),
                    (codes[:, :, 0].copy(), "grey"), (codes[:1, :1], "one pixel")):
    image = pupil_ae._image.view(array).image
    check.that(image.data == array.ctypes.data and image.height == len(array), f"{what} is copied")
same(np.ascontiguousarray(light[::-1])[::-1], light, "negative row stride")
same(np.ascontiguousarray(light[:, ::-1])[:, ::-1], light, "negative column stride")
same(np.ascontiguousarray(light[:, :, ::-1])[:, :, ::-1], light, "negative channel stride")
same(np.repeat(light, 3, 0)[::3], light, "each third row")
same(np.repeat(light, 2, 1)[:, ::2], light, "each second column")
same(np.asfortranarray(light), light, "Fortran order")
same(np.ascontiguousarray(light.transpose(2, 0, 1)).transpose(1, 2, 0), light, "channels first, transposed")
same(light.astype(">f4"), light, "big-endian")
same(np.dstack([light, light])[:, :, 3:], light, "three of six channels")
read_only = light.copy()
read_only.flags.writeable = False
same(read_only, light, "read-only")
same(np.frombuffer(light.tobytes(), np.float32).reshape(light.shape), light, "from bytes")
unaligned = np.frombuffer(b"\0" + light.tobytes(), np.uint8)[1:].view(np.float32).reshape(light.shape)
check.that(not unaligned.flags.aligned, "that array should be unaligned")
same(unaligned, light, "unaligned")
same(np.broadcast_to(light[:1], light.shape), np.repeat(light[:1], 40, 0), "one row, broadcast")
same(np.broadcast_to(light[0, 0], light.shape), np.tile(light[0, 0], (40, 60, 1)), "one pixel, broadcast")
same(light.view(type("Mine", (np.ndarray,), {"__array_finalize__": lambda self, other: None})), light, "a subclass")
with tempfile.NamedTemporaryFile() as file:
    file.write(light.tobytes())
    file.flush()
    same(np.memmap(file.name, np.float32, "r", shape=light.shape), light, "memory-mapped")
same(light[:, :1][:, [0] * 60], np.repeat(light[:, :1], 60, 1), "fancy index")
same(light[:1, :1], light[:1, :1].copy(), "one pixel of a large array")
same(light[:, :1], light[:, :1].copy(), "one column of a large array")
far_apart = np.lib.stride_tricks.as_strided(np.zeros(1 << 28, np.uint8), (2, 8, 3), (1 << 27, 3, 1))
same(far_apart, np.zeros((2, 8, 3), np.uint8), "rows 128 MiB apart")
same(codes[:, :, :1], codes[:, :, 0], "one channel as an axis")
same(memoryview(codes), codes, "a memoryview")
same(np.frombuffer(bytearray(codes.tobytes()), np.uint8).reshape(codes.shape), codes, "a bytearray")
same(codes[:, :, ::-1].copy(), codes[:, :, ::-1], "pixel=BGR8 of a copy", pixel="bgr8")
odd = light.copy()
odd[3, 4] = np.nan, np.inf, -np.inf
check.that(tuple(picture_of(odd)[3, 4]) == (0, 0, 0), "NaN is black")

# planes: as one array and as a tuple, padded
i420 = random.integers(0, 256, (60, 60), dtype=np.uint8)
y, cb, cr = i420[:40], i420[40:50].reshape(20, 30), i420[50:].reshape(20, 30)
padded = np.zeros((40, 128), np.uint8)
padded[:, :60] = y
same((y, cb, cr), i420, "I420 as planes", pixel="I420")
same([y, cb, cr], i420, "I420 as a list of planes", pixel="I420")
check.raises(TypeError, "as RGB32F must be one array, not a tuple of 1", picture_of, (light,), pixel="RGB32F")
same((padded, cb, cr), i420, "I420 with padded rows", pixel="I420", width=60)
for name, array in (("I420", i420), ("I420_10", i420.astype(np.uint16) * 4)):
    cut = (array[:40, :50], array[40:50].reshape(20, 30)[:, :25], array[50:].reshape(20, 30)[:, :25])
    same(array, cut, f"{name} with padded rows in one array", pixel=name, width=50)
whole = random.integers(0, 65536, (3, 20, 32), dtype=np.uint16)
same(whole, whole[:, :, :30].copy(), "I444_16 with padded rows", pixel="I444_16", width=30)
same(i420, (i420[:40, :49], i420[40:, :50]), "NV12 of an odd width in padded rows", pixel="NV12", width=49)
same((padded[:, :60], np.repeat(cb, 2, 0)[::2], cr[::-1].copy()[::-1]), i420, "planes with strides", pixel="I420")
same(np.repeat(i420, 2, 0)[::2], i420, "I420 with gaps", pixel="I420")
same((y, np.dstack([cb, cr])), np.vstack([y, np.dstack([cb, cr]).reshape(20, 60)]), "NV12 as planes", pixel="NV12")
same(np.repeat(i420, 2, 0)[::2], i420, "NV12 with gaps", pixel="NV12")
raw = random.integers(0, 256, (36, 100), dtype=np.uint8)
same(raw, raw[:, :80].copy(), "packed rows with padding", pixel="BAYER10P", width=64)
odd_planes = tuple(random.integers(0, 256, shape, dtype=np.uint8) for shape in ((5, 7), (3, 4), (3, 4)))
check.that(picture_of(odd_planes, pixel="I420").shape == (5, 7, 3), "odd sizes as planes")

# 8-bit grey is from a picture file, coded for a display; if its format is named it is a sensor's
check.that(not np.array_equal(picture_of(codes[:, :, 0]), picture_of(codes[:, :, 0], pixel="GREY8")), "grey is coded")
same(codes[:, :, 0], np.repeat(codes[:, :, :1], 3, 2), "grey as three channels")

# --- inputs that are refused ---
for frame, words in (
        (light.astype(np.float64), "astype(numpy.float32)"),
        (light.astype(np.int32), "array of int32"),
        (light > 1, "array of bool"),
        (light.astype(np.complex64), "array of complex64"),
        (light[:, :, 0], "numpy.repeat(frame[..., None], 3, 2)"),
        (light[:, :, :2], "shape (40, 60, 2)"),
        (light[None], "shape (1, 40, 60, 3)"),
        (light.ravel(), "shape (7200,)"),
        (np.ascontiguousarray(light.transpose(2, 0, 1)), "transpose(1, 2, 0)"),
        (np.float32(3), "shape ()"),
        (None, "NoneType"),
        ("frame.png", "array of <U9"),
        (object(), "object"),
        ([[1, 2], [3, 4]], "array of int64"),
        (np.ma.masked_less(light, 1), "filled(value)"),
        (np.zeros((4, 4), [("r", "f4"), ("g", "f4")]), "array of [("),
        ((y, cb, cr), "name their format")):
    check.raises(TypeError, words, picture_of, frame)
for shape in ((0, 60, 3), (40, 0, 3), (16385, 1, 3), (1, 16385, 3)):
    check.raises(ValueError, "from 1 to 16384", picture_of, np.zeros(shape, np.uint8))
check.raises(ValueError, "no pixel format 'RGB9'; these are: RGBA32F", picture_of, light, pixel="RGB9")
check.raises(ValueError, "no pixel format 99", picture_of, light, pixel=99)
check.raises(TypeError, "as BGR8 must be an array of uint8 with the shape (any, any, 3), not of float32 with (40, 60",
             picture_of, light, pixel="BGR8")
check.raises(TypeError, "as BAYER12 must be an array of uint16 with the shape (any, any)", picture_of, codes,
             pixel="BAYER12")
check.raises(ValueError, "as NV12 cannot have 40 rows", picture_of, y, pixel="NV12")
check.raises(ValueError, "as I444_16 cannot have 40 rows", picture_of, y.astype(np.uint16), pixel="I444_16")
check.raises(ValueError, "must have an even width", picture_of, i420[:, :59], pixel="NV12")
check.raises(ValueError, "must have an even width", picture_of, codes[:, :59, :2], pixel="YUYV")
check.raises(ValueError, "60 x 0 pixels", picture_of, (y[:0], cb[:0].reshape(0, 15, 2)), pixel="NV12")
check.raises(TypeError, "must be 3 planes, not a tuple of 2", picture_of, (y, cb), pixel="I420")
check.raises(ValueError, "it must be (20, 30)", picture_of, (y, cb[:9], cr), pixel="I420")
check.raises(ValueError, "width must be from 1 to 80", picture_of, raw, pixel="BAYER10P", width=81)
check.raises(pupil_ae.Error, "of a mosaic even", picture_of, np.zeros((3, 3), np.uint8), pixel="BAYER8")

# --- outputs ---
out = np.empty((40, 60, 3), np.uint8)
check.that(picture_of(light, out=out) is out and np.array_equal(out, picture_of(light)), "out is returned")
canvas = np.full((100, 100, 3), 7, np.uint8)
picture_of(light, out=canvas[10:50, 20:80])
check.that(np.array_equal(canvas[10:50, 20:80], out), "out as a region")
canvas[10:50, 20:80] = 7
check.that((canvas == 7).all(), "nothing outside the region is written")
upside_down = np.empty_like(out)
picture_of(light, out=upside_down[::-1])
check.that(np.array_equal(upside_down[::-1], out), "out upside down")
for dtype, channels, name in ((np.uint8, 4, "RGBA8"), (np.float32, 3, "RGB32F"), (np.float32, 4, "RGBA32F"),
                              (np.float16, 3, "RGB16F"), (np.float16, 4, "RGBA16F")):
    mine = np.empty((40, 60, channels), dtype)
    picture_of(light, out=mine)
    check.that(np.array_equal(mine, picture_of(light, out_pixel=name)), f"out as {name}")
floats = picture_of(light, out_pixel="RGB32F")
check.that(floats.min() >= 0 and floats.max() <= 1 and floats.dtype == np.float32, "floats are from 0 to 1")
blue = light[:, :, ::-1].copy()
check.that(np.array_equal(picture_of(blue, pixel="BGR32F")[:, :, ::-1], out), "blue first in is blue first out")
check.that(np.array_equal(picture_of(blue, pixel="BGR32F", out=np.empty((40, 60, 3), np.float32))[:, :, ::-1], floats),
           "blue first in floats")
bgrx = picture_of(codes, pixel="BGR8", out_pixel="BGRX8")
check.that((bgrx[:, :, 3] == 255).all(), "BGRX8 has 255")
planes = tuple(np.empty(shape, np.uint8) for shape in ((40, 60), (20, 30), (20, 30)))
check.that(picture_of(light, out=planes, out_pixel="I420") is planes, "planes as out")
check.that(np.array_equal(np.concatenate([p.ravel() for p in planes]), picture_of(light, out_pixel="I420").ravel()),
           "planes as out")
frozen = out.copy()
frozen.flags.writeable = False
for wrong, kind, words in (
        (frozen, ValueError, "out is read-only"),
        (np.frombuffer(bytes(out), np.uint8).reshape(out.shape), ValueError, "out is read-only"),
        (np.empty((40, 120, 3), np.uint8)[:, ::2], ValueError, "must be adjacent"),
        (np.empty((40, 60, 3), np.uint8)[:, :, ::-1], ValueError, "must be adjacent"),
        (np.empty((40, 60, 3), np.uint8, order="F"), ValueError, "must be adjacent"),
        (np.broadcast_to(np.empty((1, 60, 3), np.uint8), out.shape), ValueError, "out"),
        (np.empty((40, 60, 3), ">f4"), TypeError, "array of float32"),
        (np.empty((40, 60, 3)), TypeError, "float64"),
        (np.empty((40, 60), np.uint8), TypeError, "name out_pixel"),
        (np.empty((39, 60, 3), np.uint8), ValueError, "out has 60 x 39 pixels, and frame has 60 x 40"),
        (np.empty((20, 30, 3), np.uint8), ValueError, "out has 30 x 20"),
        (out.tolist(), TypeError, "numpy array, not a list"),
        (bytearray(out), TypeError, "not a bytearray"),
        (np.ma.array(out), TypeError, "masked"),
        (b"", TypeError, "not a bytes")):
    check.raises(kind, words, picture_of, light, out=wrong)
check.raises(ValueError, "shares memory", picture_of, codes, out=codes)
check.raises(ValueError, "shares memory", picture_of, large[:40, :60], out=large[39:79, 59:119])
halves = np.zeros((40, 120, 3), np.float32)
halves[:, :60] = light
picture_of(halves[:, :60], out=halves[:, 60:])
check.that(np.array_equal(halves[:, 60:], floats), "the right half of a canvas, from its left half")
check.raises(ValueError, "pupil writes RGBA8", picture_of, light, out_pixel="YUYV")
check.raises(ValueError, "even width", picture_of, light[:, :59], out_pixel="NV12")

# a refused call changes nothing
pupil = pupil_ae.Pupil()
pupil.process(light)
before = pickle.dumps(pupil)
check.raises(TypeError, "float64", pupil.process, light * 2.0 + np.zeros(1))
check.raises(ValueError, "shares memory", pupil.process, codes, out=codes)
check.raises(pupil_ae.Error, "of a mosaic even", pupil.process, np.zeros((3, 3), np.uint8), pixel="BAYER8")
check.that(pickle.dumps(pupil) == before, "a refused call changes nothing")
check.end()
