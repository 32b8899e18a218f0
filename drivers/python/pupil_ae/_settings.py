"""Keywords into the fields of a C struct, and a struct's fields into values of Python."""
import ctypes
import difflib
import operator
import textwrap

import numpy as np

from . import _abi
from ._library import Error, sentence_of

_HIDDEN = ("size_bytes", "reserved", "reserved_too", "key_points")


def fields_of(struct):
    """The names that a caller may see."""
    return [name for name, _ in struct._fields_ if name not in _HIDDEN]


def enum_of(struct, name):
    return _abi.ENUM_OF.get(f"{struct.__name__}.{name}")


def number(name, value):
    try:
        if isinstance(value, (str, bytes)):  # float() would read "0.5"
            raise TypeError
        return float(value)
    except (TypeError, ValueError):
        raise TypeError(f"{name} must be a number, not {value!r}") from None


def integer(name, value, low, high):
    """Refuses what ctypes would cut silently."""
    try:
        whole = operator.index(value)
    except TypeError:
        raise TypeError(f"{name} must be a whole number, not {value!r}") from None
    if not low <= whole <= high:
        raise ValueError(f"{name} must be from {low} to {high}, not {whole}")
    return whole


def enumerated(name, enum, value):
    """A member from its name in any case, its number or itself."""
    if isinstance(value, str):
        try:
            return enum[value.upper()]
        except KeyError:
            raise ValueError(f"{name} must be one of {', '.join(enum.__members__)}, not {value!r}") from None
    return integer(name, value, 0, 2**32 - 1)


def _set_array(struct, name, kind, value):
    field = getattr(struct, name)
    wanted, target = [], field
    while isinstance(target, ctypes.Array):
        wanted.append(len(target))
        target = target[0]
    array = np.asarray(value)
    if array.dtype.kind not in "iuf" or (array.ndim != 1 if len(wanted) == 1 else array.shape != tuple(wanted)):
        raise ValueError(f"{name} must be an array of numbers of the shape {tuple(wanted)}, not {value!r}")
    if len(wanted) == 1 and len(array) > wanted[0]:
        raise ValueError(f"{name} has room for {wanted[0]} numbers, not {len(array)}")
    view = np.ctypeslib.as_array(field)
    if view.dtype.kind == "u" and array.size and (array.min() < 0 or array.max() > np.iinfo(view.dtype).max
                                                   or array.dtype.kind == "f"):
        raise ValueError(f"{name} must be whole numbers from 0 to {np.iinfo(view.dtype).max}")
    view[...] = 0
    view[tuple(slice(length) for length in array.shape)] = array


def _set_pairs(struct, name, count_name, value):
    """key_at and stage: pairs of numbers, and how many there are."""
    room = len(getattr(struct, name))
    try:
        pairs = np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError):  # words, or pairs of other lengths
        pairs = np.zeros(1)
    if pairs.ndim == 0 or pairs.size and (pairs.ndim != 2 or pairs.shape[1] != 2) or len(pairs) > room:
        raise ValueError(f"{name} must be at most {room} pairs of numbers, not {value!r}")
    setattr(struct, count_name, len(pairs))
    getattr(struct, name)[:] = [type(getattr(struct, name)[0])()] * room
    for index, pair in enumerate(pairs):
        getattr(struct, name)[index] = type(getattr(struct, name)[0])(*pair)


def apply(struct, values):
    """Each keyword into its field; TypeError for one that the struct does not have."""
    kinds = dict(struct._fields_)
    names = fields_of(type(struct))
    for name, value in values.items():
        if name not in names:
            near = difflib.get_close_matches(name, names, 1)
            raise TypeError(f"{name!r} is no setting" + (f": is {near[0]!r} meant?" if near else ""))
        kind = kinds[name]
        if name == "key_at":
            _set_pairs(struct, name, "key_points", value)
        elif name == "stage":
            _set_pairs(struct, name, "stages", value)
        elif issubclass(kind, ctypes.Array):
            _set_array(struct, name, kind, value)
        elif kind in (ctypes.c_float, ctypes.c_double):
            setattr(struct, name, number(name, value))
        else:
            enum = enum_of(type(struct), name)
            setattr(struct, name, enumerated(name, enum, value) if enum else integer(name, value, 0, 2**32 - 1))


def checked(struct, function, *arguments):
    """The struct, or Error with the library's sentence."""
    wrong = sentence_of(function, struct, *arguments)
    if wrong:
        raise Error(*wrong)
    return struct


def values_of(struct):
    """The fields as numbers, members of enumerations, and arrays that the caller owns."""
    found = {}
    for name in fields_of(type(struct)):
        value, enum = getattr(struct, name), enum_of(type(struct), name)
        if name == "key_at":
            value = [(point.scene_ev, point.key) for point in value[:struct.key_points]]
        elif name == "stage":
            value = [(stage.exposure_s, stage.gain) for stage in value[:struct.stages]]
        elif isinstance(value, ctypes.Array):
            value = np.ctypeslib.as_array(value).copy()
        elif enum:
            try:
                value = enum(value)
            except ValueError:  # of a library that is newer
                pass
        found[name] = value
    return found


def struct_of(kind, values):
    """A struct of the fields that a caller may see, in their order; of arrays the first elements."""
    struct = kind()
    struct.size_bytes = ctypes.sizeof(kind)
    for name, value in zip(fields_of(kind), values):
        if isinstance(getattr(struct, name), ctypes.Array):
            getattr(struct, name)[:len(value)] = value
        else:
            setattr(struct, name, value)
    return struct


def about(struct):
    """The fields of a struct, for a docstring: the comments of its header."""
    lines = []
    for name in fields_of(struct):
        enum = enum_of(struct, name)
        words = _abi.ABOUT[f"{struct.__name__}.{name}"]
        if enum:
            words = f"{', '.join(enum.__members__)}. {words}"
        lines.append(textwrap.fill(f"{name}: {words}", 110, initial_indent=" " * 8, subsequent_indent=" " * 12))
    return "\n".join(lines)


def frame_info(timestamp_ns, sequence, exposure_s, gain):
    info = _abi.pupil_frame_info()
    info.size_bytes = ctypes.sizeof(info)
    info.timestamp_ns = integer("timestamp_ns", timestamp_ns, -2**63, 2**63 - 1)
    info.sequence = integer("sequence", sequence, 0, 2**64 - 1)
    info.exposure_s = number("exposure_s", exposure_s)
    info.gain = number("gain", gain)
    return info
