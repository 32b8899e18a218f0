"""Settings, copies, threads, fork, and misuse of objects."""
import copy
import ctypes
import gc
import multiprocessing
import os
import pickle
import signal
import threading

import numpy as np

import check
import pupil_ae
from pupil_ae import Law, Pupil, Reason, State, White

random = np.random.default_rng(21)
frames = [np.exp2(random.uniform(-6, 4, (48, 64, 3))).astype(np.float32) * 2.0**(i % 5) for i in range(12)]


def run(pupil, some):
    return [pupil.process(frame).tobytes() for frame in some]


# --- settings ---
pupil = Pupil(key=0.25, white_mode="fixed", white=2, law=Law.SECONDS, metering="centre", key_at=[(-4, 0.05), (2, 0.18)])
config = pupil.config
check.that(config["key"] == 0.25 and config["white_mode"] is White.FIXED and config["white"] == 2.0, str(config))
check.that(config["weight"].shape == (16, 16) and config["weight"][8, 8] > config["weight"][0, 0], "centre")
check.that(config["key_at"] == [(-4.0, 0.05), (2.0, 0.18)], str(config["key_at"]))
pupil.retune(key_at=[], lock=True)
check.that(pupil.config["key_at"] == [] and pupil.config["lock"] == 1 and pupil.config["key"] == 0.25, "retune keeps")
pupil.retune(weight=np.eye(16, dtype=np.uint8), metering=(0, 0, 0.5, 0.5))
check.that(np.array_equal(pupil.config["weight"], np.eye(16)), "weight")
check.that(Pupil(rgb_to_xyz=np.eye(3).ravel(), primaries="matrix").config["rgb_to_xyz"][4] == 1, "matrix")
for kind, words, settings in (
        (TypeError, "'tau_drak_s' is no setting: is 'tau_dark_s' meant?", {"tau_drak_s": 1}),
        (TypeError, "'size_bytes' is no setting", {"size_bytes": 1}),
        (TypeError, "key must be a number", {"key": "bright"}),
        (TypeError, "lock must be a whole number", {"lock": 0.5}),
        (ValueError, "lock must be from 0 to 4294967295, not -1", {"lock": -1}),
        (ValueError, "law must be one of SECONDS, ", {"law": "fast"}),
        (ValueError, "weight must be an array of numbers of the shape (16, 16)", {"weight": [1, 2]}),
        (ValueError, "weight must be whole numbers from 0 to 255", {"weight": np.full((16, 16), 300)}),
        (ValueError, "weight must be whole numbers", {"weight": np.full((16, 16), 0.5)}),
        (ValueError, "at most 8 pairs", {"key_at": [(i, 0.1) for i in range(9)]}),
        (ValueError, "at most 8 pairs", {"key_at": [1, 2]}),
        (ValueError, "at most 8 pairs", {"key_at": "-4/0.05"}),
        (ValueError, "at most 8 pairs", {"key_at": [(-4, 0.05), (2,)]}),
        (TypeError, "metering must be uniform, centre, spot or (x, y", {"metering": (0, 1)}),
        (TypeError, "metering must be uniform, centre, spot or (x, y", {"metering": 5}),
        (TypeError, "metering must be a number, not '0'", {"metering": ("0", 0, 1, 1)}),
        (ValueError, "metering must be uniform, centre, spot", {"metering": "center"}),
        (pupil_ae.Error, "key", {"key": 7}),
        (pupil_ae.Error, "key", {"key": float("nan")}),
        (pupil_ae.Error, "law", {"law": 77}),
        (pupil_ae.Error, "weight", {"weight": np.zeros((16, 16), int)}),
        (pupil_ae.Error, "outside its range", {"metering": (0, 0, 2, 1)})):
    check.raises(kind, words, Pupil, **settings)
before = pickle.dumps(pupil)
check.raises(pupil_ae.Error, "key", pupil.retune, key=7)
check.that(pickle.dumps(pupil) == before, "a refused retune changes nothing")
check.raises(pupil_ae.Error, "black", pupil.process, np.zeros((4, 4), np.uint16), pixel="GREY16",
             coding={"black": 70000})
check.raises(TypeError, "'blakc' is no setting: is 'black' meant?", pupil.process, np.zeros((4, 4), np.uint16),
             pixel="GREY16", coding={"blakc": 1})
check.raises(TypeError, "coding must be a dict", pupil.process, np.zeros((4, 4), np.uint16), coding="BT709")
check.raises(TypeError, "pupil_ae.Curve", pupil.map, frames[0], (1.0,))
check.raises(TypeError, "timestamp_ns must be a whole number", pupil.process, frames[0], timestamp_ns=1.5)
check.raises(ValueError, "timestamp_ns must be from", pupil.process, frames[0], timestamp_ns=2**63)
check.raises(TypeError, "exposure_s must be a number, not '1/60'", pupil.process, frames[0], exposure_s="1/60")
check.raises(TypeError, "gain must be a number, not None", pupil.process, frames[0], gain=None)
check.raises(AttributeError, "key", setattr, pupil, "key", 0.2)
check.raises(TypeError, "'timestamp'", pupil.process, frames[0], timestamp=1)

# --- what is reported ---
pupil = Pupil()
check.that(pupil.exposure.state is State.EMPTY and pupil.stats.pixels == 0, "empty")
check.raises(pupil_ae.Error, "no frame has been adapted to", pupil.curve)
check.raises(pupil_ae.Error, "statistics", pupil.stats.mean)
exposure = pupil.meter(frames[0], timestamp_ns=np.int64(5), exposure_s=np.float32(0.5), gain=1)
check.that(exposure == pupil.exposure and exposure.frames == 1 and exposure.state is State.SETTLED, str(exposure))
stats = pupil.stats
check.that(stats.pixels == 48 * 64 and stats.bin.shape == (512,) and stats.bin.sum() == stats.weight, str(stats))
check.that(abs(stats.mean() - exposure.metered_ev - -1) < 1e-3, f"{stats.mean()} {exposure}")
check.that(stats.quantile(0.1) < stats.quantile(0.9) < stats.peak_quantile(1.0), "quantiles")
check.raises(pupil_ae.Error, "outside its range", stats.quantile, 2)
check.raises(TypeError, "share must be a number, not '50%'", stats.quantile, "50%")
check.raises(TypeError, "low must be a number", stats.mean, "0")
check.raises(AttributeError, "no 'pixel'", lambda: stats.pixel)
merged = pupil_ae.Stats()
check.that(merged + merged == merged and pickle.loads(pickle.dumps(stats)) == stats, "statistics are values")
check.raises(pupil_ae.Error, "", lambda: stats + stats)
curve = pupil.curve()
mapper = Pupil()
check.that(np.array_equal(mapper.map(frames[0], curve), Pupil().process(frames[0], exposure_s=0.5, gain=1)), "map")
by_knots = Pupil(curve="adjust")
by_knots.meter(frames[0])
knots = by_knots.curve()
check.that(len(knots.knot) == knots.knots == 128 and knots == by_knots.curve(), "knots")
check.that(np.array_equal(mapper.map(frames[0], knots), Pupil(curve="adjust").process(frames[0])), "by knots")
check.that(mapper.exposure.frames == 0, "map does not adapt")
twin = Pupil()
check.that(twin.adapt(stats, timestamp_ns=5, exposure_s=0.5, gain=1) == exposure, "adapt")
check.raises(TypeError, "pupil_ae.Stats", twin.adapt, None)
pupil.process(np.zeros((4, 4, 3), np.float32))
check.that(pupil.exposure.reason is not None and isinstance(pupil.exposure.reason, Reason), "a reason")
pupil.reset()
check.that(pupil.exposure.frames == 0, "reset")
check.that("tau_dark_s" in Pupil.__doc__ and "adapted_ev" in pupil_ae.Exposure.__doc__, "documented")

# --- copies ---
pupil = Pupil(tau_dark_s=0.5)
run(pupil, frames[:6])
copies = [copy.copy(pupil), copy.deepcopy(pupil), pickle.loads(pickle.dumps(pupil))]
wanted = run(pupil, frames[6:])
for one in copies:
    check.that(run(one, frames[6:]) == wanted and one.config["tau_dark_s"] == 0.5, "a copy continues")
nothing = bytes(12288), pickle.loads(before).__getstate__()[1]
check.raises(pupil_ae.Error, "not made by", Pupil().__setstate__, nothing)

# --- threads: each on its own object in parallel; all on one object without an inconsistent state ---
results = {}


def work(name, mine):
    results[name] = run(mine, frames)


threads = [threading.Thread(target=work, args=(i, Pupil())) for i in range(4)]
shared = Pupil()
threads += [threading.Thread(target=work, args=(f"shared {i}", shared)) for i in range(4)]
[thread.start() for thread in threads]
while any(thread.is_alive() for thread in threads):
    shared.retune(key=0.2)
    shared.exposure, pickle.dumps(shared), copy.copy(shared)
[thread.join() for thread in threads]
alone = run(Pupil(), frames)
check.that(all(results[i] == alone for i in range(4)), "threads with objects of their own")
check.that(shared.exposure.frames == 48, f"{shared.exposure.frames} frames of four threads")

# --- fork while another thread is in a call: the child's object is consistent, and its lock is free ---
large = np.repeat(np.repeat(frames[0], 20, 0), 20, 1)
stop = threading.Event()
busy = Pupil()


def keep_busy():
    out = np.empty(large.shape, np.uint8)
    while not stop.is_set():
        busy.process(large, out=out)


thread = threading.Thread(target=keep_busy)
thread.start()
for _ in range(10):
    child = os.fork()
    if not child:
        busy.process(frames[0])
        os._exit(0 if busy.exposure.frames else 1)
    check.that(os.waitpid(child, 0)[1] == 0, "the child uses the object")
made = [Pupil()]


def keep_making():
    while not stop.is_set():
        made.append(Pupil())
        del made[:-50]


maker = threading.Thread(target=keep_making)
maker.start()
for _ in range(10):
    child = os.fork()
    if not child:
        made[-1].process(frames[0])
        Pupil().process(frames[0])
        os._exit(0)
    check.that(os.waitpid(child, 0)[1] == 0, "the child uses an object that was made meanwhile")
stop.set()
thread.join()
maker.join()
made.clear()
check.that(str(pickle.loads(pickle.dumps(pupil_ae.Error(-12, "a sentence")))) == "a sentence", "errors can be pickled")
with multiprocessing.get_context("fork").Pool(1) as pool:
    check.that(pool.apply(run, (Pupil(), frames[:2])) == run(Pupil(), frames[:2]), "in another process")

# --- a signal's handler that uses the object, in the middle of its calls ---
handled = []
signal.signal(signal.SIGALRM, lambda *_: handled.append(shared.exposure.frames) or shared.process(frames[0]))
signal.setitimer(signal.ITIMER_REAL, 0.001, 0.001)
run(shared, frames * 10)
signal.setitimer(signal.ITIMER_REAL, 0)
check.that(handled, "a signal came")

# --- memory: temporaries that nothing else holds, objects that are freed ---
for i in range(200):
    Pupil().process(np.full((30, 40, 3), 0.5, np.float32)[::-1], out=np.empty((30, 40, 3), np.uint8))
    gc.collect() if i % 50 == 0 else None
check.that(len(pupil_ae._pupil.Locked._all) < 20, "objects are freed")
check.that(ctypes.sizeof(pupil_ae._abi.pupil_t) == 12288, "the object's size")
check.end()
