"""Sensor: exposure time and gain of a camera, from the statistics of its frames."""
import collections
import ctypes

from . import _abi
from ._library import check, lib
from ._pupil import Locked, Stats
from ._settings import about, apply, checked, fields_of, frame_info, number, values_of

Setting = collections.namedtuple("Setting", fields_of(_abi.pupil_sensor_setting))
Setting.__doc__ = ("What to write to the camera, and why. state is a SensorState, reason a SensorReason; .name "
                   "is for logs.\n\n" + about(_abi.pupil_sensor_setting))


class Sensor(Locked):
    """The exposure loop of a camera (pupil/sensor.h): gives exposure time and gain, frame by frame.

        sensor = pupil_ae.Sensor(exposure_min_s=1e-4, exposure_max_s=1/30, gain_max=16)
        write(sensor.setting)
        for each frame:
            meter.meter(frame)                     # meter = pupil_ae.Pupil(histogram=1)
            setting = sensor.frame(meter.stats, timestamp_ns=..., sequence=..., exposure_s=..., gain=...)
            if setting.changed: write(setting)     # exposure_s in seconds, gain as a factor

    exposure_s and gain of a frame are those that this very frame was taken with, where the camera reports them; else
    leave them out. Do not give what was asked for last. Statistics are those of the frame as the camera delivered it.

    Errors: TypeError and ValueError for arguments, pupil_ae.Error for what the library refuses. Nothing has changed
    then.
    Threads, copies and pickling: as Pupil.

    Settings, which retune() changes:
"""
    __slots__ = ("_sensor",)

    def __init__(self, **settings):
        super().__init__()
        self._config = _abi.pupil_sensor_config()
        lib.pupil_sensor_config_default_sized(self._config, ctypes.sizeof(self._config))
        self._config = self._changed(settings)
        self._sensor = _abi.pupil_sensor()
        check(lib.pupil_sensor_init(self._sensor, self._config))

    def _changed(self, settings):
        config = _abi.pupil_sensor_config.from_buffer_copy(self._config)
        apply(config, settings)
        return checked(config, lib.pupil_sensor_config_check)

    @property
    def config(self):
        """All settings as a dict."""
        with self._lock:
            return values_of(self._config)

    def retune(self, **settings):
        """Changes these settings at once; the others, and the wanted total, are kept."""
        with self._lock:
            config = self._changed(settings)
            check(lib.pupil_sensor_retune(self._sensor, config))
            self._config = config

    def start(self, exposure_s, gain=1.0):
        """Begins with the product of both: what the camera has now, or total_s of an earlier run. Returns the
        Setting."""
        with self._lock:
            check(lib.pupil_sensor_start(self._sensor, number("exposure_s", exposure_s), number("gain", gain)))
            return self._setting()

    def frame(self, stats, *, timestamp_ns=0, sequence=0, exposure_s=0.0, gain=0.0):
        """The Stats of a frame, and its metadata as of Pupil.process. Returns the Setting that is wanted now."""
        if not isinstance(stats, Stats):
            raise TypeError(f"stats must be a pupil_ae.Stats (Pupil.stats), not a {type(stats).__name__}")
        info = frame_info(timestamp_ns, sequence, exposure_s, gain)
        with self._lock:
            check(lib.pupil_sensor_frame(self._sensor, stats._struct, info))
            return self._setting()

    def scene(self, scene_ev, clipped_share=0.0, *, timestamp_ns=0, sequence=0, exposure_s=0.0, gain=0.0):
        """Where something else has metered: log2 of the light of the scene, and the share 0..1 that was clipped."""
        info = frame_info(timestamp_ns, sequence, exposure_s, gain)
        scene_ev, clipped_share = number("scene_ev", scene_ev), number("clipped_share", clipped_share)
        with self._lock:
            check(lib.pupil_sensor_scene(self._sensor, scene_ev, clipped_share, info))
            return self._setting()

    def _setting(self):
        struct = _abi.pupil_sensor_setting()
        check(lib.pupil_sensor_get_sized(self._sensor, struct, ctypes.sizeof(struct)))
        return Setting(**values_of(struct))

    @property
    def setting(self):
        """The Setting that is wanted now; after Sensor() it must be written to the camera, whatever that had."""
        with self._lock:
            return self._setting()

    def __getstate__(self):
        with self._lock:
            return bytes(self._sensor), bytes(self._config)

    def __setstate__(self, state):
        Locked.__init__(self)
        self._sensor = _abi.pupil_sensor.from_buffer_copy(state[0])
        self._config = _abi.pupil_sensor_config.from_buffer_copy(state[1])
        self._setting()  # refused where another version made the object


Sensor.__doc__ += about(_abi.pupil_sensor_config)
