"""Camera-style auto-exposure for frames in numpy arrays: libpupil, by ctypes. No compiler is needed.

    import pupil_ae
    pupil = pupil_ae.Pupil()
    picture = pupil.process(frame)               # (rows, columns, 3) float32 in, uint8 out
    print(pupil.exposure.adapted_ev)

Pupil maps frames; its docstring has the formats. Sensor controls a camera's exposure time and gain."""
from ._abi import (VERSION, Bayer, GainLaw, Law, Level, Light, Matrix, Order, OutputPrimaries, Pixel, Primaries, Range,
                   Reason, SensorMains, SensorMode, SensorReason, SensorState, State, Transfer, White)
from ._library import Error
from ._pupil import Curve, Exposure, Pupil, Stats
from ._sensor import Sensor, Setting

__version__ = ".".join(map(str, VERSION))
__all__ = ["Bayer", "Curve", "Error", "Exposure", "GainLaw", "Law", "Level", "Light", "Matrix", "Order",
           "OutputPrimaries", "Pixel", "Primaries", "Pupil", "Range", "Reason", "Sensor", "SensorMains", "SensorMode",
           "SensorReason", "SensorState", "Setting", "State", "Stats", "Transfer", "White"]
