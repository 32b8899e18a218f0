#!/usr/bin/env python3
"""picamera2_loop [FRAMES]: exposure time and gain of a Raspberry Pi's camera, by pupil, frame by frame.

NOT RUN ON A BOARD: tests run it with a simulated camera in the place of picamera2. On the Pi, with pupil installed:

    apt-get install python3-picamera2 python3-numpy
    python3 picamera2_loop.py"""
import sys

import pupil_ae
from picamera2 import Picamera2

camera = Picamera2()
camera.configure(camera.create_video_configuration(main={"format": "RGB888", "size": (1280, 720)}))
(shortest, longest, _), (least, most, _) = (camera.camera_controls[name] for name in ("ExposureTime", "AnalogueGain"))
# linear=0: the picture has gone through the ISP's tone curve.
sensor = pupil_ae.Sensor(linear=0, frame_s=1 / 30, exposure_min_s=max(shortest, 1) * 1e-6,
                         exposure_max_s=min(longest * 1e-6, 1 / 30), gain_min=least, gain_max=most)
meter = pupil_ae.Pupil(histogram=1)


def write(setting):
    exposure_us, gain = round(setting.exposure_s * 1e6), setting.gain
    camera.set_controls({"AeEnable": False, "ExposureTime": exposure_us, "AnalogueGain": gain})


write(sensor.setting)
camera.start()
for number in range(int(sys.argv[1]) if len(sys.argv) > 1 else 300):
    request = camera.capture_request()
    frame, data = request.make_array("main"), request.get_metadata()
    request.release()
    of_frame = {"timestamp_ns": data["SensorTimestamp"], "sequence": number + 1,
                "exposure_s": data["ExposureTime"] * 1e-6, "gain": data["AnalogueGain"] * data.get("DigitalGain", 1.0)}
    meter.meter(frame, pixel="BGR8")  # "RGB888" is blue first in memory
    setting = sensor.frame(meter.stats, **of_frame)
    if setting.changed:
        write(setting)
    print(f"{number} {setting.exposure_s * 1e3:.2f} ms, gain {setting.gain:.2f}, {setting.state.name.lower()}")
camera.stop()
