"""Pupil: frames in, pictures out. Stats: what metering leaves of a frame."""
import collections
import ctypes
import os
import threading
import weakref

import numpy as np

from . import _abi
from ._image import out_view, view
from ._library import check, lib
from ._settings import about, apply, checked, fields_of, frame_info, number, struct_of, values_of

Exposure = collections.namedtuple("Exposure", fields_of(_abi.pupil_exposure))
Exposure.__doc__ = ("The state after the last frame. EV are log2 of scene luminance. state is a State, reason a Reason."
                    "\n\n" + about(_abi.pupil_exposure))
Curve = collections.namedtuple("Curve", fields_of(_abi.pupil_curve), defaults=(0, 0, 0.0, ()))
Curve.__doc__ = ("What maps a frame: u = scale * luminance, display RGB = v * scale * (1 + u * inverse_white_squared) "
                 "/ (1 + u), or where it has knots, by those; pupil/pupil.h has the formulas, and says what happens "
                 "beyond the gamut. knot is a tuple, empty where there are none.\n\n" + about(_abi.pupil_curve))


class Locked:
    """An object of the library and its lock: a call that changes it must be the only one. fork() waits for calls in
    other threads, so that a child has whole objects."""

    __slots__ = ("_lock", "_config", "__weakref__")  # so that pupil.key = 1 is an error: retune(key=1) is meant
    _all = weakref.WeakSet()
    _guard = threading.RLock()  # of _all
    _held = []

    def __init__(self):
        # A signal's handler may come between two lines of this thread's own call, and may use the object.
        self._lock = threading.RLock()
        with Locked._guard:
            Locked._all.add(self)

    @staticmethod
    def _before_fork():
        Locked._guard.acquire()
        Locked._held = list(Locked._all)
        for each in Locked._held:
            each._lock.acquire()

    @staticmethod
    def _after_fork():
        for each in Locked._held:
            each._lock.release()
        Locked._held = []
        Locked._guard.release()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(before=Locked._before_fork, after_in_parent=Locked._after_fork,
                        after_in_child=Locked._after_fork)


def _metering(config, pattern):
    """config.weight by a pattern's name or a rectangle."""
    if isinstance(pattern, str):
        named = {"uniform": lib.pupil_metering_uniform, "centre": lib.pupil_metering_centre,
                 "spot": lib.pupil_metering_spot}
        if pattern not in named:
            raise ValueError(f"metering must be uniform, centre, spot or (x, y, width, height), not {pattern!r}")
        check(named[pattern](config))
    else:
        try:
            x, y, width, height = pattern
        except (TypeError, ValueError):
            raise TypeError("metering must be uniform, centre, spot or (x, y, width, height), not "
                            f"{pattern!r}") from None
        check(lib.pupil_metering_roi(config, *(number("metering", value) for value in (x, y, width, height))))


class Stats:
    """The statistics of a frame (pupil/stats.h): integers, so that parts add up to the whole exactly.

    Fields are attributes: pixels, weight, black, clipped, bad, bin (512 weights by luminance), peak_bin and so on;
    arrays are copies. `a + b` merges the parts of one frame."""

    def __init__(self, struct=None):
        if struct is None:
            struct = _abi.pupil_stats()
            lib.pupil_stats_clear_sized(struct, ctypes.sizeof(struct))
        self._struct = struct

    def __getattr__(self, name):
        if name not in fields_of(_abi.pupil_stats):
            raise AttributeError(f"Stats has no {name!r}; it has {', '.join(fields_of(_abi.pupil_stats))}")
        value = getattr(self._struct, name)
        return np.ctypeslib.as_array(value).copy() if isinstance(value, ctypes.Array) else value

    def __dir__(self):
        return super().__dir__() + fields_of(_abi.pupil_stats)

    def __add__(self, more):
        if not isinstance(more, Stats):
            return NotImplemented
        total = _abi.pupil_stats.from_buffer_copy(self._struct)
        check(lib.pupil_stats_add(total, more._struct))
        return Stats(total)

    def __eq__(self, other):
        return isinstance(other, Stats) and bytes(self._struct) == bytes(other._struct)

    __hash__ = None

    def __reduce__(self):
        return _stats_of, (bytes(self._struct),)

    def __repr__(self):
        return f"<Stats of {self.pixels} pixels, {self.clipped} clipped, {self.black} black>"

    def _number(self, function, *arguments):
        result = ctypes.c_double()
        check(function(self._struct, *arguments, result))
        return result.value

    def mean(self, low=0.0, high=1.0):
        """log2 of the luminance, the mean over the weight between the shares low and high; stops. Error without
        light."""
        return self._number(lib.pupil_stats_mean, number("low", low), number("high", high))

    def quantile(self, share):
        """log2 of the luminance that the share 0..1 of the weight is below. Error without a histogram."""
        return self._number(lib.pupil_stats_quantile, number("share", share))

    def peak_quantile(self, share):
        """The same of each pixel's brightest channel."""
        return self._number(lib.pupil_stats_peak_quantile, number("share", share))

    def grey_world(self):
        """Three factors for coding={"balance": ...} that make a mosaic's average grey (needs grey_world=1)."""
        balance = (ctypes.c_float * 3)()
        check(lib.pupil_stats_grey_world(self._struct, balance))
        return tuple(balance)


def _stats_of(memory):
    return Stats(_abi.pupil_stats.from_buffer_copy(memory))


class Pupil(Locked):
    """Auto-exposure for a stream of frames: meters each, adapts over time, maps it to a display.

    Pupil() is right for live video; settings are keywords, listed below. metering is "uniform", "centre", "spot" or
    (x, y, width, height) as fractions of the frame. Enumerations take a name in any case.

    Frames are numpy arrays, read where they are: a region, every n-th row or an upside-down view costs no copy. Others
    whose pixels are not adjacent are copied first. The shape and dtype say the format, or pixel= names it:

        (rows, columns, 3 or 4)  float32, float16: linear light;  uint16: linear, 65535 is 1;  uint8: sRGB; red first
        (rows, columns)          uint8: grey, sRGB;  uint16: grey, linear
        pixel="BGR8", "BGR32F"   blue first, as OpenCV has it;  "BGRX8", "RGBX8": a fourth byte that is ignored
        pixel="YUYV", "UYVY"     uint8 (rows, columns, 2)
        pixel="NV12", "I420"     uint8 (rows * 3/2, columns), or a tuple of planes; also NV21, P010, I420_10 (uint16),
                                 NV16 (rows * 2), I444_16 (uint16, (3, rows, columns))
        pixel="GREY8" ...        linear grey: GREY8, GREY10, GREY12, GREY16; packed (rows, bytes): GREY10P, GREY12P
        pixel="BAYER10" ...      a raw mosaic: BAYER8, BAYER10, BAYER12, BAYER14, BAYER16; packed: BAYER10P, BAYER12P
        pixel="RGB10A2"          uint32 (rows, columns)

    coding is a dict of what the samples mean (pupil/coding.h): {"matrix": "BT709", "range": "FULL", "light": "PQ",
    "bayer": "BGGR", "black": 64, "balance": (1.9, 1, 1.6)}.

    Of each frame: timestamp_ns, the middle of its exposure in ns of a monotonic clock; without any, frames are
    nominal_frame_s apart. sequence, the driver's number. exposure_s in seconds and gain (1 is none), where both are
    known.

    Errors: TypeError for a dtype, shape or keyword that does not fit, ValueError for a value or a read-only output,
    pupil_ae.Error (a ValueError, with .code) for what the library refuses. Nothing has changed then.

    Threads: calls on one object wait for each other; calls on different objects run at the same time. Objects can be
    copied (copy.copy), pickled and forked: a copy continues with the same bits.

    Settings, which retune() changes:
"""
    __slots__ = ("_pupil",)

    def __init__(self, *, metering=None, **settings):
        super().__init__()
        self._config = _abi.pupil_config()
        lib.pupil_config_default_sized(self._config, ctypes.sizeof(self._config))
        self._config = self._changed(metering, settings)
        self._pupil = _abi.pupil_t()
        check(lib.pupil_init(self._pupil, self._config))

    def _changed(self, metering, settings):
        config = _abi.pupil_config.from_buffer_copy(self._config)
        if metering is not None:
            _metering(config, metering)
        apply(config, settings)
        return checked(config, lib.pupil_config_check)

    @property
    def config(self):
        """All settings as a dict."""
        with self._lock:
            return values_of(self._config)

    def retune(self, *, metering=None, **settings):
        """Changes these settings from the next frame on; the others, and the adapted level, are kept."""
        with self._lock:
            config = self._changed(metering, settings)
            check(lib.pupil_retune(self._pupil, config))
            self._config = config

    def reset(self):
        """Forgets every frame; the next one sets the level at once."""
        with self._lock:
            check(lib.pupil_reset(self._pupil))

    def process(self, frame, *, out=None, pixel=None, coding=None, width=None, out_pixel=None, out_coding=None,
                half=False, timestamp_ns=0, sequence=0, exposure_s=0.0, gain=0.0):
        """Meters, adapts and maps a frame; returns the picture.

        frame: see help(pupil_ae.Pupil). width: pixels, where rows of the array are padded.
        out: an array to write to, which is returned: uint8 (codes for a display), float32 or float16 (linear display
            light, 0..1), of the shape (rows, columns, 3 or 4). It must be writable, with adjacent pixels, and share no
            memory with frame. Without out a new uint8 array (rows, columns, 3) is made; reuse one to save its time.
        out_pixel: RGB8 by default, BGR8 where frame is blue first; or RGBA8, BGRX8, NV12, I420, RGB32F, BGR32F,
            RGBA32F, RGB16F, RGBA16F. half: a mosaic to a picture of half its size, in a quarter of the time."""
        source = view(frame, pixel, coding, width)
        picture, target = out_view(source, out, out_pixel, half, out_coding)
        info = frame_info(timestamp_ns, sequence, exposure_s, gain)
        with self._lock:
            check(lib.pupil_process(self._pupil, source.image, info, target.image))
        return picture

    def meter(self, frame, *, pixel=None, coding=None, width=None, timestamp_ns=0, sequence=0, exposure_s=0.0,
              gain=0.0):
        """Meters a frame and adapts to it, without a picture; returns the Exposure. Its statistics are in `stats`."""
        source = view(frame, pixel, coding, width)
        info = frame_info(timestamp_ns, sequence, exposure_s, gain)
        with self._lock:
            check(lib.pupil_meter(self._pupil, source.image, info))
            return self._exposure()

    def adapt(self, stats, *, timestamp_ns=0, sequence=0, exposure_s=0.0, gain=0.0):
        """Adapts to a frame that was metered elsewhere (Stats); returns the Exposure."""
        if not isinstance(stats, Stats):
            raise TypeError(f"stats must be a pupil_ae.Stats, not a {type(stats).__name__}")
        info = frame_info(timestamp_ns, sequence, exposure_s, gain)
        with self._lock:
            check(lib.pupil_adapt(self._pupil, stats._struct, info))
            return self._exposure()

    def map(self, frame, curve, *, out=None, pixel=None, coding=None, width=None, out_pixel=None, out_coding=None,
            half=False):
        """Maps a frame with a Curve; nothing adapts. As process() otherwise."""
        if not isinstance(curve, Curve):
            raise TypeError(f"curve must be a pupil_ae.Curve (Pupil.curve), not a {type(curve).__name__}")
        source = view(frame, pixel, coding, width)
        picture, target = out_view(source, out, out_pixel, half, out_coding)
        struct = struct_of(_abi.pupil_curve, curve)
        with self._lock:
            check(lib.pupil_map_rows(self._pupil, struct, source.image, target.image))
        return picture

    def _exposure(self):
        struct = _abi.pupil_exposure()
        check(lib.pupil_get_exposure_sized(self._pupil, struct, ctypes.sizeof(struct)))
        return Exposure(**values_of(struct))

    @property
    def exposure(self):
        """The Exposure after the last frame."""
        with self._lock:
            return self._exposure()

    @property
    def stats(self):
        """The Stats of the last frame."""
        struct = _abi.pupil_stats()
        with self._lock:
            check(lib.pupil_get_stats_sized(self._pupil, struct, ctypes.sizeof(struct)))
        return Stats(struct)

    def curve(self, **info):
        """The Curve for a frame; of another one than the last, with its timestamp_ns, sequence, exposure_s and gain.
        Error before the first valid frame."""
        unknown = {"timestamp_ns": 0, "sequence": 0, "exposure_s": 0.0, "gain": 0.0}
        given = frame_info(**{**unknown, **info}) if info else None
        struct = _abi.pupil_curve()
        with self._lock:
            check(lib.pupil_get_curve_sized(self._pupil, given, struct, ctypes.sizeof(struct)))
        return Curve(**{**values_of(struct), "knot": tuple(struct.knot[:struct.knots])})

    @property
    def level(self):
        """The Level of vector instructions that is used."""
        level = ctypes.c_uint32()
        with self._lock:
            check(lib.pupil_get_level(self._pupil, level))
        return _abi.Level(level.value)

    def __getstate__(self):
        with self._lock:
            return bytes(self._pupil), bytes(self._config)

    def __setstate__(self, state):
        Locked.__init__(self)
        self._pupil = _abi.pupil_t.from_buffer_copy(state[0])
        self._config = _abi.pupil_config.from_buffer_copy(state[1])
        check(lib.pupil_retune(self._pupil, self._config))  # another CPU may have other instructions


Pupil.__doc__ += about(_abi.pupil_config)
