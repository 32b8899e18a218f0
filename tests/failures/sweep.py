"""The n-th call fails: every command that writes, for each n. Nothing crashes or hangs, a failure is a sentence and an
exit status that is not 0, and leaves no output in part. A call whose failure changes nothing (status 0) must leave
outputs with the very bytes of a run without it.

    sweep.py --program PUPIL --fake RUN_FAKE --preload LIBRARY [--every 1] [--case NAME]... [--call NAME]... [--jobs 2]
             [--seconds LIMIT] [--kept FILE]

--every 7: n = 1, 8, 15, ... The calls are failed by the library (fail_nth.c).

It ends at Ctrl-C, and once it has run for LIMIT seconds. Every verdict is in FILE as soon as it is known, a line of
JSON; the next run with this file goes on where that one ended, and prints the sums of both. The file is of one program:
remove it after another build. Exits with 1 after a fault, else with 3 where calls are left.
"""
import argparse
import concurrent.futures
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time

LIMIT_S = 60
PROGRAM = []
SCENE = """size width_px 32 height_px 24
fps 10
frames 3
camera position_m 0 1.5 4 look_at_m 0 1 0 fov_degrees 50
ambient radiance 0.3 0.3 0.3
material grey diffuse 0.5 0.5 0.5
sphere material grey position_m 0 1 0 radius_m 1
"""
# Name: program, arguments, outputs, files of the user that must stay as they are.
CASES = {
    "replay-video": ("program", ["replay", "in.y4m", "-q", "-o", "out.mp4"], ["out.mp4"]),
    "replay-video-mkv": ("program", ["replay", "in.y4m", "-q", "-o", "out.mkv"], ["out.mkv"]),
    "replay-y4m": ("program", ["replay", "in.y4m", "-q", "-o", "out.y4m", "--stats", "out.csv"],
                   ["out.y4m", "out.csv"]),
    "replay-folder": ("program", ["replay", "in.y4m", "-q", "-o", "out"], ["out"]),
    "replay-over": ("program", ["replay", "in.y4m", "-q", "-y", "-o", "old"], ["old"]),
    "replay-jsonl": ("program", ["replay", "in.y4m", "-q", "--stats", "out.jsonl"], ["out.jsonl"]),
    "replay-recording": ("program", ["replay", "rec", "-q", "-o", "out.y4m"], ["out.y4m"]),
    "render": ("program", ["render", "s.scene", "-q", "-o", "out"], ["out"]),
    "render-exr": ("program", ["render", "s.scene", "-q", "-n", "1", "-o", "out.exr"], ["out.exr"]),
    "record": ("program", ["record", "in.y4m", "out", "-q"], ["out"]),
    "sim": ("program", ["sim", "--stats", "out.csv"], ["out.csv"]),
    "run-video": ("fake", ["fake:size=32x24", "-n", "20", "-q", "-o", "out.mkv"], ["out.mkv"]),
    "run-record": ("fake", ["fake:size=32x24", "-n", "8", "-q", "--record", "out", "--stats", "out.csv"],
                   ["out", "out.csv"]),
    "run-resume": ("fake", ["fake:size=32x24", "-n", "90", "-q", "--mode", "sensor", "--resume", "kept"], ["kept"]),
}
LIVE = ("out", "out.mkv", "out.csv")  # of run and record: complete frames from before the failure may stay
CUT = "a line is cut off"
CALLS = ["malloc", "write", "rename", "renameat2", "fsync", "openat", "ftruncate", "mkdir"]


def contents(folder, outputs):
    """What is in all outputs, as far as it is the same in each run: {path: bytes or a number}."""
    found = {}
    for name in outputs:
        path = folder / name
        for file in sorted(path.rglob("*")) if path.is_dir() else [path]:
            if file.is_file():
                data = file.read_bytes()
                if file.suffix in (".csv", ".jsonl"):  # microseconds: other ones in each run
                    data = len(data.split(b"\n")) if data.endswith(b"\n") else CUT
                elif file.suffix == ".mkv":  # with a random number, and an index if there was memory for it
                    what = file.parent if file.name == "frames.mkv" else file
                    data = subprocess.run([PROGRAM[0], "replay", what, "-q", "-o", "-"], capture_output=True).stdout
                found[str(file.relative_to(folder))] = data
    return found


def sizes(found):
    """Of a live run, whose bits depend on GPU or CPU: the same number of frames and of lines."""
    return {path: data if isinstance(data, (int, str)) else len(data) for path, data in found.items()}


class Kept:
    """The verdicts so far: {(case, call, n): "refused", None or a fault}; also in a file, if there is a path."""

    def __init__(self, path):
        self.path, self.verdicts, self.lock = path, {}, threading.Lock()
        text = path.read_text() if path and path.exists() else ""
        whole = text[: text.rfind("\n") + 1]  # an incomplete line is ignored
        for line in whole.splitlines():
            name, call, n, said = json.loads(line)
            self.verdicts[name, call, n] = said
        if path:
            path.write_text(whole)

    def add(self, name, call, n, said):
        with self.lock:
            self.verdicts[name, call, n] = said
            if self.path:
                with open(self.path, "a") as file:
                    file.write(json.dumps([name, call, n, said]) + "\n")


class Sweep:
    def __init__(self, options, work):
        self.options, self.work = options, work
        self.kept = Kept(options.kept)
        self.ends_at = time.monotonic() + options.seconds
        self.interrupted = False
        self.made = {}
        self.inputs = work / "inputs"
        self.make_inputs()

    def command(self, name):
        kind, arguments, outputs = CASES[name]
        return [str(getattr(self.options, kind).resolve()), *arguments], outputs

    def make_inputs(self):
        self.inputs.mkdir()
        (self.inputs / "s.scene").write_text(SCENE)
        program = str(self.options.program.resolve())
        for arguments in (["render", "s.scene", "-q", "-o", "in.y4m"], ["replay", "in.y4m", "-q", "-o", "old"],
                          ["record", "in.y4m", "rec", "-q"]):
            done = subprocess.run([program, *arguments], cwd=self.inputs, capture_output=True, text=True)
            if done.returncode:
                sys.exit(f"sweep.py: {' '.join(arguments)}: {done.stderr}")

    def run(self, command, environment=None):
        """(status, standard error, folder); status -9: it had to be killed."""
        folder = pathlib.Path(tempfile.mkdtemp(dir=self.work))
        for entry in self.inputs.iterdir():
            (shutil.copytree if entry.is_dir() else shutil.copy)(entry, folder / entry.name)
        with open(folder / ".err", "wb") as err:
            process = subprocess.Popen(command, cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                                       stderr=err, env={**os.environ, **(environment or {})}, start_new_session=True)
            try:
                status = process.wait(LIMIT_S)
            except subprocess.TimeoutExpired:
                os.killpg(process.pid, signal.SIGKILL)
                process.wait()
                status = "does not end"
        said = (folder / ".err").read_text(errors="replace")
        (folder / ".err").unlink()
        return status, said, folder

    def environment(self, name, call, n):
        own = {"PUPIL_FAIL_OWN": "1"} if "video" in name else {}  # encoders
        return {**own, "LD_PRELOAD": str(self.options.preload.resolve()), "PUPIL_FAIL": f"{call}:{n}"}

    def number_of(self, name, call):
        count = self.work / f"count-{name}-{call}"
        command, _ = self.command(name)
        _, said, folder = self.run(command, {**self.environment(name, call, 0), "PUPIL_COUNT": str(count)})
        shutil.rmtree(folder)
        if not count.exists():
            print(f"sweep.py: {name}: {said}")
            sys.exit(77 if "fail_nth: " in said else 1)
        return int(count.read_text())

    def judge(self, name, call, n):
        before, reference = self.references(name)
        command, outputs = self.command(name)
        status, said, folder = self.run(command, self.environment(name, call, n))
        try:
            said = "\n".join(line for line in said.splitlines() if not line.startswith("fake: "))
            now = contents(folder, outputs)
            stray = [p.name for p in folder.rglob(".*") if p.name not in said]  # named files are expected
            if status == "does not end" or status < 0 or status in (132, 134, 135, 136, 139):
                return f"ends by a signal or not at all ({status}): {said}"
            if status == 99 and CASES[name][0] == "fake":
                return None  # the rig's own camera, from before the program began
            if status == 0:
                return None if now == reference or CASES[name][0] == "fake" and sizes(now) == sizes(reference) else \
                    "status 0, but the outputs are others"
            if stray:
                return f"left behind: {' '.join(stray)}"
            if "pupil" not in said and not (call == "write" and not said):  # the sentence itself was not written
                return f"status {status} without a sentence: {said}"
            partial = [p for p in now if now[p] != reference.get(p) and now[p] != before.get(p)
                       and (now[p] == CUT or p.split("/")[0] not in LIVE or not name.startswith(("run", "record")))]
            return f"in part: {' '.join(partial)}" if partial else "refused"
        finally:
            shutil.rmtree(folder)

    def is_over(self):
        return self.interrupted or time.monotonic() >= self.ends_at

    def judge_once(self, name, call, n):
        """None if it is known, or the time is over."""
        if (name, call, n) in self.kept.verdicts or self.is_over():
            return
        said = self.judge(name, call, n)
        if not self.interrupted:  # else its result may come from Ctrl-C
            self.kept.add(name, call, n, said)

    def references(self, name):
        """The outputs before, and after a run without a failure: made once."""
        if name not in self.made:
            command, outputs = self.command(name)
            status, said, folder = self.run(command)
            self.made[name] = contents(self.inputs, outputs), contents(folder, outputs)
            shutil.rmtree(folder)
            if status:
                sys.exit(f"sweep.py: {name} fails without a failure: {said}")
        return self.made[name]

    def sweep(self, name, call):
        """(calls swept, harmless failures, faults, calls left)"""
        self.references(name)  # not by two at once
        numbers = range(1, self.number_of(name, call) + 1, self.options.every)
        with concurrent.futures.ThreadPoolExecutor(self.options.jobs) as pool:
            list(pool.map(lambda n: self.judge_once(name, call, n), numbers))
        said = {n: self.kept.verdicts[name, call, n] for n in numbers if (name, call, n) in self.kept.verdicts}
        faults = [(n, s) for n, s in said.items() if s not in (None, "refused")]
        return len(said), sum(s is None for s in said.values()), faults, len(numbers) - len(said)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name in ("program", "fake", "preload"):
        parser.add_argument(f"--{name}", type=pathlib.Path, required=True)
    parser.add_argument("--every", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--case", action="append")
    parser.add_argument("--call", action="append")
    parser.add_argument("--seconds", type=float, default=float("inf"))
    parser.add_argument("--kept", type=pathlib.Path)
    options = parser.parse_args()
    PROGRAM.append(options.program.resolve())
    failed = total = 0
    is_left = False
    with tempfile.TemporaryDirectory() as work:
        sweep = Sweep(options, pathlib.Path(work))

        def interrupt(*_):
            sweep.interrupted = True

        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, interrupt)
        for name in options.case or CASES:
            for call in options.call or CALLS:
                if sweep.is_over():
                    is_left = True
                    continue
                calls, harmless, faults, left = sweep.sweep(name, call)
                total += calls
                failed += len(faults)
                is_left = is_left or left > 0
                print(f"{name:18} {call:10} {calls:6} swept, {calls - harmless - len(faults):6} refused, "
                      f"{harmless:5} without effect, {len(faults)} faults" + (f", {left} left" if left else ""),
                      flush=True)
                for n, fault in faults[:5]:
                    print(f"    FAILED: {call} {n}: {fault}; again with: --case {name} --call {call}")
    print(f"{total} calls failed, {failed} faults" + ("; not all were swept" if is_left else ""))
    sys.exit(1 if failed else 3 if is_left else 0)


if __name__ == "__main__":
    main()
