"""Sensor on a simulated camera with a delay of two frames: the light rises eightfold, and falls again."""
import math
import pickle

import numpy as np

import check
import pupil_ae
from pupil_ae import Pupil, Sensor, SensorState

DELAY, KEY = 2, 0.18
sensor, meter = Sensor(exposure_min_s=1e-4, exposure_max_s=1 / 30, gain_max=16, mains_hz=0), Pupil(histogram=1)
texture = np.exp2(np.linspace(-3, 1, 64 * 48).reshape(48, 64, 1)).astype(np.float32) * np.ones(3, np.float32)
asked = [sensor.setting] * (DELAY + 1)
errors = {}
for number in range(1, 241):
    light = 8.0 if 80 < number <= 160 else 1.0
    force = asked[-1 - DELAY]
    frame = np.minimum(texture * (light * 30 * force.exposure_s * force.gain), 1).astype(np.float32)
    time_ns = number * 33333333
    meter.meter(frame, timestamp_ns=time_ns)
    setting = sensor.frame(meter.stats, timestamp_ns=time_ns, sequence=number, exposure_s=force.exposure_s,
                           gain=force.gain)
    check.that(math.isclose(setting.exposure_s * setting.gain * setting.digital, setting.total_s), str(setting))
    asked.append(setting)
    errors[number] = math.log2(2.0**meter.stats.mean() * setting.frame_digital / KEY)
for number in (80, 160, 240):
    check.that(abs(errors[number]) < 0.25, f"frame {number} is {errors[number]:.3f} stops off")
check.that(sensor.setting.state in (SensorState.CONVERGED, SensorState.FLICKER), str(sensor.setting))
check.that(asked[160].total_s < asked[80].total_s / 4, "the light went up")

twin = pickle.loads(pickle.dumps(sensor))
for one in (twin, sensor):
    one.frame(meter.stats, timestamp_ns=241 * 33333333, sequence=241)
check.that(twin.setting == sensor.setting and pickle.dumps(twin) == pickle.dumps(sensor), "a copy continues")
check.that(math.isclose(Sensor().start(0.005, 2).total_s, 0.01), "start")
check.that(Sensor().scene(3.0, timestamp_ns=1, sequence=1).frames == 1, "scene")
sensor.retune(key=0.25, gain_law="table", gain_table=[1, 2, 4], gain_count=3, stage=[(0.01, 4)])
check.that(sensor.config["gain_table"][2] == 4 and sensor.config["stage"] == [(0.01, 4.0)], "tables")
check.raises(pupil_ae.Error, "exposure_min_s", Sensor, exposure_min_s=0)
check.raises(TypeError, "is no setting", Sensor, iso=100)
check.raises(ValueError, "has room for 64", Sensor, gain_table=[1] * 65)
check.raises(TypeError, "pupil_ae.Stats", sensor.frame, frame)
check.raises(TypeError, "exposure_s must be a number, not '1/60'", Sensor().start, "1/60")
check.raises(TypeError, "scene_ev must be a number", Sensor().scene, "dark")
check.raises(pupil_ae.Error, "range", Sensor().start, -1)
check.that("delay_frames" in Sensor.__doc__, "documented")
check.end()
