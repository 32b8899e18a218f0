"""The part of Picamera2 that docs/examples/picamera2_loop.py uses, with a simulated sensor: controls act three
frames later, and the picture is coded as sRGB. $PUPIL_FAKE_LIGHT: the light, which is eight times as strong from
frame 60 on."""
import atexit
import os

import numpy as np

DELAY = 3


def coded(light):
    light = np.clip(light, 0, 1)
    return np.where(light < 0.0031308, 12.92 * light, 1.055 * light**(1 / 2.4) - 0.055)


class Request:
    def __init__(self, number, exposure_us, gain):
        self.number, self.exposure_us, self.gain, self.released = number, exposure_us, gain, False

    def make_array(self, name):
        assert name == "main" and not self.released
        strength = float(os.environ["PUPIL_FAKE_LIGHT"]) * (8 if self.number >= 60 else 1)
        column = coded(np.exp2(np.linspace(-3, 1, 720)) * strength * self.exposure_us * 1e-6 * self.gain)
        return np.repeat(np.round(255 * column).astype(np.uint8), 1280 * 3).reshape(720, 1280, 3)

    def get_metadata(self):
        return {"SensorTimestamp": 10**9 + self.number * 33333333, "ExposureTime": self.exposure_us,
                "AnalogueGain": self.gain, "DigitalGain": 1.0}

    def release(self):
        self.released = True


class Picamera2:
    camera_controls = {"ExposureTime": (75, 11766829, 20000), "AnalogueGain": (1.0, 16.0, 1.0)}

    def __init__(self):
        self.number, self.asked, self.open, self.last = 0, [], [], None
        atexit.register(self.report)

    def create_video_configuration(self, main):
        return {"main": main}

    def configure(self, configuration):
        assert configuration["main"] == {"format": "RGB888", "size": (1280, 720)}

    def set_controls(self, controls):
        assert set(controls) == {"AeEnable", "ExposureTime", "AnalogueGain"} and controls["AeEnable"] is False
        assert isinstance(controls["ExposureTime"], int)
        for name in ("ExposureTime", "AnalogueGain"):
            low, high, _ = self.camera_controls[name]
            assert low <= controls[name] <= high, (name, controls[name])
        self.asked.append((self.number, controls["ExposureTime"], controls["AnalogueGain"]))

    def start(self):
        assert self.asked

    def stop(self):
        self.number = -self.number

    def capture_request(self):
        assert all(request.released for request in self.open), "a request was not released"
        in_force = [self.asked[0]] + [asked for asked in self.asked if asked[0] + DELAY <= self.number]
        self.number += 1
        self.last = Request(self.number, *in_force[-1][1:])
        self.open = [self.last]
        return self.last

    def report(self):
        """The light as shown by the last frame: the log-average of its texture is 2^-1."""
        shown = 0.5 * float(os.environ["PUPIL_FAKE_LIGHT"]) * 8 * self.last.exposure_us * 1e-6 * self.last.gain
        print(f"fake: stopped {self.number < 0}, shown {shown:.4f}")
