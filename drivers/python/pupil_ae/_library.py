"""libpupil, loaded and checked: its version, and the last field of each struct."""
import ctypes
import os
import pathlib

from . import _abi


class Error(ValueError):
    """libpupil refused a call. `code` is one of PUPIL_ERR_... (pupil/error.h); the text is the library's sentence."""

    def __init__(self, code, sentence):
        super().__init__(code, sentence)
        self.code = code

    def __str__(self):
        return self.args[1]


def _load():
    """$PUPIL_LIBRARY; else the library that was installed or built with this module; else what the system's loader
    finds."""
    named = os.environ.get("PUPIL_LIBRARY")
    if named:
        return ctypes.CDLL(named)
    here = pathlib.Path(__file__).resolve().parent
    for place in _abi.PLACES:
        path = here / place / _abi.SONAME
        if path.exists():
            return ctypes.CDLL(str(path))
    try:
        return ctypes.CDLL(_abi.SONAME)
    except OSError as reason:
        raise ImportError(f"pupil_ae does not find {_abi.SONAME} ({reason}): install pupil, or set PUPIL_LIBRARY to "
                          "the library's file") from None


lib = _load()
for _name, (_result, _parameters) in _abi.FUNCTIONS.items():
    _function = getattr(lib, _name, None)
    if _function is None:
        raise ImportError(f"{lib._name} has no {_name}: it is older than this pupil_ae")
    _function.restype, _function.argtypes = _result, _parameters


def check(code):
    if code:
        raise Error(code, lib.pupil_error_string(code).decode())


def sentence_of(check_function, *arguments):
    """The fault that one of the library's checks finds; None if there is none."""
    why = ctypes.c_char_p()
    code = check_function(*arguments, ctypes.byref(why))
    return (code, (why.value or b"").decode()) if code else None


def _faults():
    """How the library's structs differ from this module's: a value at the end of each struct is written by one side
    and read by the other."""
    version = lib.pupil_version().decode()
    if version.split(".")[:2] != [str(number) for number in _abi.VERSION[:2]]:
        yield f"its version is {version}"
    config, sensor_config, coding = _abi.pupil_config(), _abi.pupil_sensor_config(), _abi.pupil_coding()
    lib.pupil_config_default_sized(config, ctypes.sizeof(config))
    lib.pupil_sensor_config_default_sized(sensor_config, ctypes.sizeof(sensor_config))
    guarded = (_abi.pupil_t * 2)()
    info = _abi.pupil_frame_info(size_bytes=ctypes.sizeof(_abi.pupil_frame_info), exposure_s=0.25, gain=0.5)
    light = (ctypes.c_float * 48)(*[40.0] * 48)
    frame = _abi.pupil_image_const(size_bytes=ctypes.sizeof(_abi.pupil_image_const), pixel=_abi.Pixel.RGB32F,
                                   data=ctypes.addressof(light), stride_bytes=48, width=4, height=4)
    exposure, stats, curve = _abi.pupil_exposure(), _abi.pupil_stats(), _abi.pupil_curve()
    sensor, setting = (_abi.pupil_sensor * 2)(), _abi.pupil_sensor_setting()
    if lib.pupil_init(guarded[0], config) or lib.pupil_meter(guarded[0], frame, info):
        yield "it refuses a plain frame"
    lib.pupil_get_exposure_sized(guarded[0], exposure, ctypes.sizeof(exposure))
    lib.pupil_get_stats_sized(guarded[0], stats, ctypes.sizeof(stats))
    lib.pupil_get_curve_sized(guarded[0], None, curve, ctypes.sizeof(curve))
    lib.pupil_sensor_init(sensor[0], sensor_config)
    lib.pupil_sensor_get_sized(sensor[0], setting, ctypes.sizeof(setting))
    if any(bytes(guarded[1])) or any(bytes(sensor[1])):
        yield "its objects are larger"
    # 40 / (0.25 * 0.5) is 2^8.3219
    if (exposure.frames, exposure.state) != (1, _abi.State.SETTLED) or abs(exposure.metered_ev - 8.3219) > 1e-3:
        yield "pupil_frame_info or pupil_exposure differs"
    if stats.pixels != 16 or sum(stats.bin) != 16 or sum(stats.band_pixels) != 16:
        yield "pupil_stats differs"
    if abs(curve.scale * 40 / config.key - 1) > 1e-3 or curve.first_row:
        yield "pupil_curve differs"
    if not setting.total_s or abs(setting.exposure_s * setting.gain * setting.digital / setting.total_s - 1) > 1e-9:
        yield "pupil_sensor_setting differs"
    config.dither = sensor_config.exposure_count = 77
    coding.knees, coding.knee_code[0], coding.knee_light[0] = 1, 1000, 77
    for field, wrong in (("dither", sentence_of(lib.pupil_config_check, config)),
                         ("exposure_count", sentence_of(lib.pupil_sensor_config_check, sensor_config)),
                         ("knee_light", sentence_of(lib.pupil_coding_check, coding, _abi.Pixel.GREY16))):
        if not wrong or field not in wrong[1]:
            yield f"{field} is not where it should be"


def _check():
    faults = "; ".join(_faults())
    if faults:
        raise ImportError(f"this pupil_ae was made for libpupil {'.'.join(map(str, _abi.VERSION))} and does not fit "
                          f"{lib._name}: {faults}. Install both from one build")


_check()
