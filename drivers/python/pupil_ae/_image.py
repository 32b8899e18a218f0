"""Pictures of numpy as the library's images: no copy where pixels of a row are adjacent, a clear error elsewhere."""
import ctypes
import math

import numpy as np

from . import _abi
from ._abi import Pixel
from ._library import lib
from ._settings import apply, checked, integer

_COLOUR = {"F4": ("RGB32F", "RGBA32F"), "F2": ("RGB16F", "RGBA16F"), "U2": ("RGB16", "RGBA16"), "U1": ("RGB8", "RGBA8")}
_GREY = {"U2": "GREY16", "U1": "GREY8"}
_READS = ("float32, float16, uint16 or uint8 with 3 or 4 channels, or uint16 or uint8 without channels")
# An 8-bit grey picture of a file, of OpenCV or PIL is coded for a display; a sensor's, which pixel= names, is linear.
_DISPLAY_GREY = _abi.pupil_coding(size_bytes=ctypes.sizeof(_abi.pupil_coding), light=_abi.Light.SRGB)


def _sample(pixel):
    """The dtype of a format's samples, from its name."""
    name = pixel.name
    if name.endswith("32F"):
        return np.dtype(np.float32)
    if name.endswith("16F"):
        return np.dtype(np.float16)
    if name == "RGB10A2":
        return np.dtype(np.uint32)
    wide = name in ("P010", "I420_10") or (name.endswith(("10", "12", "14", "16")) and name != "NV16")
    return np.dtype(np.uint16 if wide and name != "NV12" else np.uint8)


SAMPLE = {pixel: _sample(pixel) for pixel in Pixel if pixel}
CHANNELS = {pixel: 4 if "A" in pixel.name or "X" in pixel.name else 3
            for pixel in Pixel if pixel.name[:3] in ("RGB", "BGR") and pixel.name != "RGB10A2"}
PACKED = {Pixel.BAYER10P: (4, 5), Pixel.GREY10P: (4, 5), Pixel.BAYER12P: (2, 3), Pixel.GREY12P: (2, 3)}
PAIRED = (Pixel.YUYV, Pixel.UYVY)


def pixel_of(value):
    """A Pixel from its name in any case, or itself."""
    try:
        pixel = Pixel[value.upper()] if isinstance(value, str) else Pixel(value)
    except (KeyError, ValueError):
        pixel = Pixel.NONE
    if pixel == Pixel.NONE:
        raise ValueError(f"there is no pixel format {value!r}; these are: "
                         f"{', '.join(name for name in Pixel.__members__ if name != 'NONE')}")
    return pixel


def is_planar(value):
    return lib.pupil_pixel_planes(pixel_of(value)) > 1


def _guess(array, what):
    """The format of a picture whose dtype and channels leave no doubt; blue first is never guessed."""
    kind = f"{array.dtype.kind.upper()}{array.dtype.itemsize}"
    if array.ndim == 3 and array.shape[2] in (3, 4) and kind in _COLOUR:
        return Pixel[_COLOUR[kind][array.shape[2] - 3]]
    if (array.ndim == 2 or array.ndim == 3 and array.shape[2] == 1) and kind in _GREY:
        return Pixel[_GREY[kind]]
    hint = ""
    if kind == "F8":
        hint = f"; use {what}.astype(numpy.float32)"
    elif array.dtype == object:
        hint = "; of a cv2.UMat use .get()"
    elif array.ndim == 2 and array.dtype.kind == "f":
        hint = f"; of grey floats use numpy.repeat({what}[..., None], 3, 2)"
    elif array.ndim == 3 and array.shape[0] in (3, 4) and kind in _COLOUR:
        hint = f"; are the channels first? use {what}.transpose(1, 2, 0)"
    elif array.ndim == 3 and array.shape[2] == 2:
        hint = "; of YUYV or UYVY give pixel="
    raise TypeError(f"{what} is an array of {array.dtype} with the shape {array.shape}: pupil reads {_READS}{hint}")


def _array_of(frame, what):
    if isinstance(frame, np.ma.MaskedArray):
        raise TypeError(f"{what} is a masked array: say what masked pixels are, with {what}.filled(value)")
    array = np.asarray(frame)
    if array.dtype == object and array.size < 2:
        raise TypeError(f"{what} is a {type(frame).__name__}, which is no array; of a cv2.UMat use .get()")
    return array


def _expect(array, shape, sample, pixel, what):
    if array.dtype != sample or any(want is not None and want != have for want, have in zip(shape, array.shape)) \
            or len(shape) != array.ndim:
        wanted = ", ".join("any" if length is None else str(length) for length in shape)
        raise TypeError(f"{what} as {pixel.name} must be an array of {sample} with the shape ({wanted}), not of "
                        f"{array.dtype} with {array.shape}")


def _planar_height(pixel, rows, what):
    """Rows of Y' where an array of `rows` rows has all planes."""
    if pixel in (Pixel.NV16, Pixel.I444_16):
        planes = 2 if pixel == Pixel.NV16 else 3
        if rows % planes == 0:
            return rows // planes
    elif rows % 3 != 1:
        return (rows * 2 + 1) // 3
    raise ValueError(f"{what} as {pixel.name} cannot have {rows} rows: the array has Y' first, then the chroma, "
                     f"{'twice' if pixel == Pixel.NV16 else 'three times' if pixel == Pixel.I444_16 else '3/2 of'} the "
                     "picture's rows")


class View:
    """What a call needs of a picture: a C image of the kind `struct`, and `arrays`, the memory that it points to."""

    def __init__(self, struct, frame, pixel, coding, width, what, writable):
        self.writable, self.what, self.arrays = writable, what, []
        self.image = struct(size_bytes=ctypes.sizeof(struct))
        if isinstance(frame, tuple) or isinstance(frame, list) and pixel is not None and is_planar(pixel):
            self._planes(frame, pixel, width)
        else:
            self._one(_array_of(frame, what), pixel, width)
        self.coding = coding_of(coding, self.pixel)
        if self.coding is None and pixel is None and self.pixel == Pixel.GREY8:
            self.coding = _DISPLAY_GREY
        if self.coding is not None:
            self.image.coding = ctypes.pointer(self.coding)
        self.image.pixel = self.pixel

    def _memory(self, array, row_bytes, whole=False):
        """The address and stride of rows whose bytes are adjacent. An input is copied if they are not; `whole`: the
        rows must follow each other, too."""
        adjacent = array.flags.aligned and array.dtype.isnative and (
            array.shape[0] == 1 or abs(array.strides[0]) >= row_bytes) and all(
                array.shape[axis] == 1 or array.strides[axis] == array.itemsize * math.prod(array.shape[axis + 1:])
                for axis in range(1, array.ndim))
        if whole:
            adjacent = adjacent and array.flags.c_contiguous
        if self.writable and not array.flags.writeable:
            raise ValueError(f"{self.what} is read-only: use a copy")
        if not adjacent:
            if self.writable:
                raise ValueError(f"{self.what}: the pixels of a row must be adjacent in memory, aligned and in the "
                                 f"machine's byte order, not with the strides {array.strides}; use numpy.empty("
                                 f"{array.shape}, numpy.{array.dtype.name})")
            array = np.array(array, dtype=array.dtype.newbyteorder("="), order="C", copy=True)
        self.arrays.append(array)
        stride = array.strides[0] if array.shape[0] > 1 else row_bytes
        return array.__array_interface__["data"][0], stride

    def _size(self, width, height):
        if not (1 <= width <= _abi.PUPIL_MAX_SIDE_PX and 1 <= height <= _abi.PUPIL_MAX_SIDE_PX):
            raise ValueError(f"{self.what} has {width} x {height} pixels: both must be from 1 to "
                             f"{_abi.PUPIL_MAX_SIDE_PX}")
        self.image.width, self.image.height = width, height

    def _one(self, array, pixel, width):
        self.pixel = pixel = _guess(array, self.what) if pixel is None else pixel_of(pixel)
        sample = SAMPLE[pixel]
        if not self.writable and array.dtype.newbyteorder("=") == sample:
            array = array.astype(sample, copy=False)
        if array.ndim == 3 and array.shape[2] == 1 and pixel not in CHANNELS:
            array = array[:, :, 0]
        if pixel in CHANNELS:
            _expect(array, (None, None, CHANNELS[pixel]), sample, pixel, self.what)
            columns, height = array.shape[1], array.shape[0]
        elif pixel in PAIRED and array.ndim == 3:
            _expect(array, (None, None, 2), sample, pixel, self.what)
            columns, height = array.shape[1], array.shape[0]
        else:
            if pixel == Pixel.I444_16 and array.ndim == 3:
                _expect(array, (3, None, None), sample, pixel, self.what)
                array = array.reshape(-1, array.shape[2])
            _expect(array, (None, None), sample, pixel, self.what)
            height, columns = array.shape
            if pixel in PACKED:
                columns = columns // PACKED[pixel][1] * PACKED[pixel][0]
            elif pixel in PAIRED:
                columns //= 2
            elif lib.pupil_pixel_planes(pixel) > 1:
                height = _planar_height(pixel, height, self.what)
        if width is not None:
            columns = integer("width", width, 1, columns)
        self._size(columns, height)
        planes = lib.pupil_pixel_planes(pixel)
        row_bytes = lib.pupil_row_bytes(pixel, columns)
        paired = pixel in PAIRED and array.ndim == 3 or planes > 1 and pixel != Pixel.I444_16
        if paired and array.shape[1] % 2:
            raise ValueError(f"{self.what} as one array of {pixel.name} must have an even width, not {array.shape[1]}")
        if math.prod(array.shape[1:]) * array.itemsize < row_bytes:
            raise ValueError(f"{self.what} has too few columns for {columns} pixels of {pixel.name}")
        address, stride = self._memory(array, row_bytes, whole=planes == 3)
        self.image.data, self.image.stride_bytes = address, stride
        if planes > 1:
            chroma_row = lib.pupil_chroma_row_bytes(pixel, array.shape[1])  # of padded rows, too
            self.image.chroma = address + stride * height
            self.image.chroma_stride_bytes = stride if planes == 2 else chroma_row
            if planes == 3:
                self.image.cr = self.image.chroma + chroma_row * lib.pupil_chroma_rows(pixel, height)
                self.image.cr_stride_bytes = chroma_row

    def _planes(self, planes, pixel, width):
        if pixel is None:
            raise TypeError(f"{self.what} is a tuple of planes: name their format, pixel=\"I420\" for example")
        self.pixel = pixel = pixel_of(pixel)
        count, sample = lib.pupil_pixel_planes(pixel), SAMPLE[pixel]
        if len(planes) != count or count < 2:
            wanted = f"{count} planes" if count > 1 else "one array"
            raise TypeError(f"{self.what} as {pixel.name} must be {wanted}, not a tuple of {len(planes)}")
        arrays = [_array_of(plane, f"plane {index} of {self.what}") for index, plane in enumerate(planes)]
        arrays = [array.reshape(array.shape[0], math.prod(array.shape[1:]))
                  if array.ndim == 3 and array.flags.c_contiguous else array for array in arrays]
        for index, array in enumerate(arrays):
            _expect(array, (None, None), sample, pixel, f"plane {index} of {self.what}")
        height, columns = arrays[0].shape
        columns = columns if width is None else integer("width", width, 1, columns)
        self._size(columns, height)
        chroma_row, rows = lib.pupil_chroma_row_bytes(pixel, columns), lib.pupil_chroma_rows(pixel, height)
        for index, array in enumerate(arrays[1:], 1):
            if array.shape[0] != rows or array.shape[1] * array.itemsize < chroma_row:
                raise ValueError(f"plane {index} of {self.what} has the shape {array.shape}: of {columns} x {height} "
                                 f"pixels it must be ({rows}, {chroma_row // array.itemsize})")
        self.image.data, self.image.stride_bytes = self._memory(arrays[0], lib.pupil_row_bytes(pixel, columns))
        self.image.chroma, self.image.chroma_stride_bytes = self._memory(arrays[1], chroma_row)
        if count == 3:
            self.image.cr, self.image.cr_stride_bytes = self._memory(arrays[2], chroma_row)


def coding_of(coding, pixel):
    """A pupil_coding from a dict of its fields."""
    if coding is None:
        return None
    if not isinstance(coding, dict):
        raise TypeError(f"coding must be a dict of pupil_coding's fields, not a {type(coding).__name__}")
    struct = _abi.pupil_coding(size_bytes=ctypes.sizeof(_abi.pupil_coding))
    apply(struct, coding)
    return checked(struct, lib.pupil_coding_check, pixel)


def view(frame, pixel=None, coding=None, width=None):
    return View(_abi.pupil_image_const, frame, pixel, coding, width, "frame", False)


def _out_pixel(out, given):
    """The format of an output array: blue first where the input is."""
    blue = given.name.startswith("BGR")
    if not isinstance(out, np.ndarray):
        raise TypeError(f"out must be a numpy array, not a {type(out).__name__}; of planes name out_pixel")
    array = _array_of(out, "out")
    kind = f"{array.dtype.kind.upper()}{array.dtype.itemsize}"
    if array.ndim == 3 and array.shape[2] in (3, 4) and kind in ("F4", "F2", "U1"):
        name = _COLOUR[kind][array.shape[2] - 3]
        return Pixel["BGR" + name[3:]] if blue and name in ("RGB8", "RGB32F") else Pixel[name]
    raise TypeError(f"out is an array of {array.dtype} with the shape {array.shape}: pupil writes uint8, float32 or "
                    "float16 with 3 or 4 channels; of others name out_pixel")


def empty(pixel, width, height):
    """An array for a picture of this format."""
    if pixel in CHANNELS:
        return np.empty((height, width, CHANNELS[pixel]), SAMPLE[pixel])
    if pixel in (Pixel.NV12, Pixel.I420) and width % 2 == 0:
        return np.empty((height + (height + 1) // 2, width), np.uint8)
    if pixel in (Pixel.NV12, Pixel.I420):
        raise ValueError(f"an array of {pixel.name} must have an even width, not {width}")
    raise ValueError(f"pupil writes RGBA8, RGB8, BGRX8, BGR8, NV12, I420, RGBA32F, RGB32F, BGR32F, RGBA16F and RGB16F, "
                     f"not {pixel.name}")


def _overlap(left, right):
    return np.may_share_memory(left, right) and np.shares_memory(left, right)


def out_view(source, out, out_pixel, half, coding=None):
    """(the array that is returned, its View). `half`: a mosaic to half its size."""
    divisor = 2 if half else 1
    width, height = source.image.width // divisor, source.image.height // divisor
    if out is None:
        given = "BGR8" if source.pixel.name.startswith("BGR") else "RGB8"
        pixel = pixel_of(out_pixel if out_pixel is not None else given)
        out = empty(pixel, width, height)
    else:
        pixel = pixel_of(out_pixel) if out_pixel is not None else _out_pixel(out, source.pixel)
        if not all(isinstance(plane, np.ndarray) for plane in (out if isinstance(out, tuple) else (out,))):
            raise TypeError("out must be a numpy array or a tuple of these: nothing else can be written to")
    target = View(_abi.pupil_image, out, pixel, coding, None, "out", True)
    fits = [(source.image.width, source.image.height)]
    if lib.pupil_pixel_is_mosaic(source.pixel):
        fits.append((source.image.width // 2, source.image.height // 2))
    if (target.image.width, target.image.height) not in fits:
        raise ValueError(f"out has {target.image.width} x {target.image.height} pixels, and frame has "
                         f"{source.image.width} x {source.image.height}")
    if any(_overlap(mine, theirs) for mine in source.arrays for theirs in target.arrays):
        raise ValueError("out shares memory with frame: a picture cannot be mapped in place")
    return out, target
