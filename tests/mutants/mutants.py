"""Machine-made mutants of a room of the library: which of them the tests do not notice.

    mutants.py [--build BUILD] [--room lib/sensor] [--tests REGEX] [--extra "PROGRAM ARGUMENTS"]... [--slowest SECONDS]
               [--count 200] [--seed 16] [--jobs 2] [--least 95] [--seconds LIMIT] [--kept FILE] [--sanitize]

BUILD is a configured build of the tree with tests (build/dev), whose programs of these tests are up to date. ROOMS has
the rooms; that of the kernels is their scalar reference, and needs a build with -DPUPIL_LEVELS=scalar. A mutant
is one change of one file (mutations.py), compiled as BUILD does, but with -O1, and linked before the library, so that
it takes the place of the file. The tests are those of ctest that match REGEX (as a rule those of the room in ROOMS) and
have the label quick, and the extra ones; those that take longer than SLOWEST are left out. The fastest and those that
have killed most come first, until one fails. One that takes ten times as long as without the mutant is killed, and so
is the mutant. These times are those of a processor, so they are the same where other programs run.

Kinds of mutation are drawn in turn, and places within a kind at random, from the seed, until COUNT mutants compile to
code that is not the same as before. After LIMIT seconds the rest of them is left; the next run with the same FILE goes
on there: the killed ones are not tried again, and what survived only by other tests, after the rest. With --sanitize
what survives is tried once more with the sanitizers of preset.asan, which see a read beyond an array. Prints what
survived, and exits with 1 where less than LEAST percent of those are killed that are not in equivalent.txt. There, a
line is one surviving line as it is printed, from the file's name on but without the line's number, then " # " and the
reason why no test can notice.
"""
import argparse
import concurrent.futures
import copy
import hashlib
import json
import math
import os
import pathlib
import random
import re
import resource
import shlex
import signal
import subprocess
import sys
import tempfile
import time

import mutations

HERE = pathlib.Path(__file__).resolve().parent
TREE = HERE.parent.parent
SHORTEST_LIMIT_S = 5.0
LINK_S = 0.1
NO_CACHE = dict(os.environ, CCACHE_DISABLE="1")  # it would only keep objects that are never compiled again
SANITIZERS = ["-fsanitize=address,undefined", "-fno-sanitize-recover=all"]
os.environ.setdefault("ASAN_OPTIONS", "detect_leaks=0")  # the tests', not the mutant's
OUT_OF_TIME = (-signal.SIGXCPU, 128 + signal.SIGXCPU)  # a program's, and that of a shell that ran it
# For each room the names of its files, and its tests.
ROOMS = {
    "lib/base": (r".", r"^(base|core|flicker|stream)\."),
    "lib/core": (r".", r"^(core|stream|scene|row_gain)\."),
    "lib/flicker": (r".", r"^(flicker|stream)\."),
    "lib/kernels": (r"^(scalar|yuv|luma)\.c", r"^(core|stream|scene|kernels)\."),
    "lib/look": (r".", r"^look\."),
    "lib/sensor": (r".", r"^sensor\."),
}


class Test:
    """link: the arguments that link it, with OBJECT and PROGRAM in their place; run: those that run it; program: as it
    was built."""

    def __init__(self, name, link, run, folder, program):
        self.name, self.link, self.run, self.folder, self.program = name, link, run, folder, program
        self.seconds, self.kills = 0.0, 0

    def passes(self, mutant_object, work, limit_s, flags=()):
        """"passed", "failed", "timed out" or "did not link"."""
        program = str(work / "program")
        replaced = {"OBJECT": str(mutant_object), "PROGRAM": program}
        link = [replaced.get(a, a) for a in self.link]
        if subprocess.run([*link, *flags], cwd=self.folder, stderr=subprocess.DEVNULL).returncode:
            return "did not link"
        process = subprocess.Popen([replaced.get(a, a) for a in self.run], cwd=work, stdin=subprocess.DEVNULL,
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True,
                                   preexec_fn=lambda: limited(limit_s))
        code, self.last_s = ended(process, limit_s)
        return "timed out" if code is None else "passed" if code in (0, 76, 77) else "failed"


def limited(limit_s):
    """In the child."""
    if limit_s:
        seconds = math.ceil(limit_s)
        resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 1))


def ended(process, limit_s):
    """The exit code, or None if it was killed at a limit; and the processor seconds of it and its children. These
    are limited, so that a busy machine kills nothing; so is, more loosely, a program's waiting time."""
    last = time.monotonic() + 60.0 * (limit_s or float("inf"))
    while True:
        pid, status, usage = os.wait4(process.pid, os.WNOHANG)
        if pid:
            process.returncode = os.waitstatus_to_exitcode(status)
            code = None if process.returncode in OUT_OF_TIME else process.returncode
            return code, usage.ru_utime + usage.ru_stime
        if time.monotonic() > last:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()
            return None, limit_s
        time.sleep(0.01)


class Source:
    """One file of the room. compile: arguments with SOURCE and OBJECT in their place."""

    def __init__(self, path, name, compiler):
        self.path, self.name, self.compiler = path, name, compiler
        self.text = path.read_text()

    def compiled(self, text, obj, flags=()):
        """The object's bytes, or None. The same text gives the same bytes, because the copy has the file's name."""
        with tempfile.TemporaryDirectory(dir=obj.parent) as folder:
            own = pathlib.Path(folder) / self.path.name
            own.write_text(f'#line 1 "{self.path.name}"\n' + text)
            replaced = {"SOURCE": own.name, "OBJECT": str(obj)}
            arguments = [replaced.get(a, a) for a in self.compiler] + ["-iquote", str(self.path.parent), *flags]
            if subprocess.run(arguments, cwd=folder, stderr=subprocess.DEVNULL, env=NO_CACHE).returncode:
                return None
        return obj.read_bytes()


def drawn(sources, seed):
    """All mutations except those of extremes, in an order that takes the kinds in turn and is random within each."""
    kinds = {}
    for source in sources:
        for m in mutations.mutations_of(source.text):
            kinds.setdefault(m.kind, []).append((source, m))
    generator = random.Random(seed)
    for name in sorted(kinds):
        generator.shuffle(kinds[name])
    order = []
    while any(kinds.values()):
        order += [kinds[name].pop() for name in sorted(kinds) if kinds[name]]
    return [(source, m) for source, m in order if not mutations.is_of_extreme(source.text, m)]


def description(source, m):
    """Without the line's number, which changes with any edit of the file."""
    shown = [" ".join(t.split()) or "(nothing)" for t in (m.before, m.after)]
    line_start = source.text.rfind("\n", 0, m.start) + 1
    same_before = source.text[line_start : m.start].count(m.before)
    which = f" (number {same_before + 1})" if m.before and same_before else ""
    return f"{source.name}: {shown[0]} -> {shown[1]}{which} in: {mutations.source_line(source.text, m)}"


def excuses(path):
    lines = path.read_text().splitlines() if path.exists() else []
    return {line.split(" # ")[0].strip() for line in lines if " # " in line}


def compiled_mutants(sources, count, seed, work, jobs, ends_at, kept):
    """The first COUNT that compile to other code: (source, mutation, object). Also how many did not compile, and how
    many gave the same code."""
    plain = {s.name: s.compiled(s.text, work / "plain.o") for s in sources}
    found, number_of = [], {"broken": 0, "same": 0}
    order = list(enumerate(drawn(sources, seed)))

    def compiled(one):
        number, (source, m) = one
        obj = work / f"mutant{number}.o"
        if not kept.of(source, m):
            code = source.compiled(mutations.mutated(source.text, m), obj)
            kind = "broken" if code is None else "same" if code == plain[source.name] else "other"
            kept.add(source, m, kind)
        return source, m, obj

    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        while order and len(found) < count and time.monotonic() < ends_at:
            n = min(20, count - len(found))
            some, order = order[:n], order[n:]
            for source, m, obj in pool.map(compiled, some):
                if kept.of(source, m) in number_of:
                    number_of[kept.of(source, m)] += 1
                else:
                    found.append((source, m, obj))
    return found, number_of["broken"], number_of["same"]


def timed(tests, plain_object, work, slowest_s, kept=None, flags=()):
    """The tests that pass with the unchanged object, the fastest first."""
    good = []
    for test in tests:
        name = f"plain {tests_id([test])} {slowest_s} {len(flags)}"
        known = kept.verdicts.get(name) if kept else None
        if known:
            said, test.seconds = "passed", float(known)
        else:
            said = test.passes(plain_object, work, 3 * slowest_s if slowest_s < float("inf") else None, flags)
            test.seconds = getattr(test, "last_s", 3 * slowest_s)
        if kept and said == "passed" and not known:
            kept.write(name, str(test.seconds))
        if said == "passed" and test.seconds <= slowest_s:
            good.append(test)
        else:
            print(f"mutants.py: {test.name} {said} in {test.seconds:.1f} s without a mutant: left out")
    return sorted(good, key=lambda t: t.seconds)


def judged(tests, obj, work, flags=()):
    """"survived", or which test killed it and how."""
    for test in sorted(tests, key=lambda t: (t.seconds + LINK_S) / (1 + t.kills)):
        said = test.passes(obj, work, max(SHORTEST_LIMIT_S, 10 * test.seconds), flags)
        if said != "passed":
            test.kills += 1
            return f"{test.name} {said}"
    return "survived"


def tests_id(tests):
    """Changes if a test is added, removed or rebuilt."""
    said = [f"{t.name} {pathlib.Path(t.program).stat().st_mtime}" for t in sorted(tests, key=lambda t: t.name)]
    return hashlib.sha256("\n".join(said).encode()).hexdigest()[:16]


class Kept:
    """Results of earlier runs, one a line: the key, tab, the verdict; or how long a test takes. Results of a changed
    file do not count; survivors also name their tests."""

    def __init__(self, path):
        self.path, self.verdicts = path, {}
        if path and path.exists():
            self.verdicts = dict(line.split("\t") for line in path.read_text().splitlines())

    def name(self, source, m):
        text = hashlib.sha256(source.text.encode()).hexdigest()[:16]
        return f"{source.name} {text} {m.start} {m.end} {' '.join(m.after.split())}"

    def of(self, source, m):
        return self.verdicts.get(self.name(source, m))

    def add(self, source, m, verdict):
        self.write(self.name(source, m), verdict)

    def write(self, name, said):
        self.verdicts[name] = said
        if self.path:
            with self.path.open("a") as file:
                file.write(f"{name}\t{said}\n")


def run(sources, tests, count, seed, jobs, excused, work, slowest_s=float("inf"), limit_s=float("inf"),
        kept=None, sanitize=False):
    """Prints what survived; returns (killed, survivors that are not excused, excused ones, verdicts)."""
    ends_at = time.monotonic() + limit_s
    kept = kept or Kept(None)
    mutants, broken, same = compiled_mutants(sources, count, seed, work, jobs, ends_at, kept)
    sources[0].compiled(sources[0].text, work / "plain.o")
    tests = timed(tests, work / "plain.o", work, slowest_s, kept)
    if sanitize:
        sources[0].compiled(sources[0].text, work / "plain.o", SANITIZERS)
        sanitized = timed([copy.copy(t) for t in tests], work / "plain.o", work, 3 * slowest_s, kept, SANITIZERS)
    print(f"mutants.py: {len(mutants)} mutants ({broken} more did not compile, {same} are the same code); "
          + ", ".join(f"{t.name} {t.seconds:.1f} s" for t in tests), flush=True)
    folders = [pathlib.Path(tempfile.mkdtemp(dir=work)) for _ in range(jobs)]

    def judge(mutant):
        source, m, obj = mutant
        if time.monotonic() >= ends_at:
            return
        folder = folders.pop()
        if not obj.exists():
            source.compiled(mutations.mutated(source.text, m), obj)
        verdict = judged(tests, obj, folder)
        if verdict == "survived" and sanitize and source.compiled(mutations.mutated(source.text, m), obj, SANITIZERS):
            verdict = judged(sanitized, obj, folder, SANITIZERS)
            verdict += "" if verdict == "survived" else ", sanitized"
        kept.add(source, m, survived if verdict == "survived" else verdict)
        folders.append(folder)

    survivors, equivalent, killers, verdicts = [], [], {}, []
    survived = f"survived {tests_id(tests)}{'s' if sanitize else ''}"
    undecided = [(s, m, o) for s, m, o in mutants
                 if kept.of(s, m) == "other" or (kept.of(s, m).startswith("survived") and kept.of(s, m) != survived)]
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        list(pool.map(judge, sorted(undecided, key=lambda one: kept.of(*one[:2]) != "other")))
    for source, m, _ in mutants:
        said, verdict = description(source, m), kept.of(source, m)
        if verdict == "other":
            continue
        verdict = verdict.split()[0] if verdict.startswith("survived") else verdict
        verdicts.append((source, m, verdict))
        if verdict != "survived":
            killers[verdict] = killers.get(verdict, 0) + 1
            continue
        (equivalent if said in excused else survivors).append(said)
        is_excused = " (equivalent)" if said in excused else ""
        line = mutations.line_of(source.text, m)
        print(f"survived{is_excused}: {said.replace(':', f':{line}:', 1)}", flush=True)
    if len(verdicts) < len(mutants):
        print(f"  the time is over: {len(verdicts)} of {len(mutants)} were tried")
    for name, number in sorted(killers.items(), key=lambda pair: -pair[1]):
        print(f"  {number:4} {name}")
    return sum(killers.values()), survivors, equivalent, verdicts


def tests_of(build, regex, extra):
    """The tests of ctest, and how ninja links their programs."""
    listed = subprocess.run(["ctest", "--test-dir", str(build), "--show-only=json-v1", "-R", regex, "-L",
                             "^quick$"], stdout=subprocess.PIPE, check=True, text=True).stdout
    commands = [(t["name"], t["command"]) for t in json.loads(listed)["tests"]]
    for line in extra:
        program, *arguments = shlex.split(line)
        commands.append((line, [str(build / "tests" / program), *arguments]))
    tests = []
    for name, command in commands:
        programs = [pathlib.Path(a) for a in command if a.startswith(f"{build}/") and os.access(a, os.X_OK)]
        if not programs:
            continue  # a script that needs none
        target = str(programs[0].relative_to(build))
        ninja = subprocess.run(["ninja", "-C", str(build), "-t", "commands", target], stdout=subprocess.PIPE,
                               check=True, text=True).stdout.splitlines()[-1]
        link = shlex.split(re.sub(r"^: && | && :$", "", ninja))
        link[link.index("-o") + 1] = "PROGRAM"
        link.append("-s")  # nothing reads what debuggers need, and it takes most of the linker's time
        link.insert(next(i for i, a in enumerate(link) if a.endswith(".a")), "OBJECT")
        tests.append(Test(name, link, ["PROGRAM" if a == str(programs[0]) else a for a in command], build,
                          programs[0]))
    return tests


def sources_of(build, room):
    sources = []
    for entry in json.loads((build / "compile_commands.json").read_text()):
        path = pathlib.Path(entry["file"])
        if not re.search(ROOMS[room][0], path.name):
            continue
        arguments = shlex.split(entry["command"])
        output = arguments[arguments.index("-o") + 1]
        if path.parent != TREE / room or "pupil_objects" not in output:
            continue
        flags = [a for a in arguments if not re.match(r"-(W|g|O)", a)]
        flags[flags.index("-o") + 1] = "OBJECT"
        flags[flags.index("-c") + 1] = "SOURCE"
        sources.append(Source(path, f"{room}/{path.name}", flags[:1] + ["-O1", "-w"] + flags[1:]))
    return sorted(sources, key=lambda s: s.name)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=pathlib.Path, default=TREE / "build" / "dev")
    parser.add_argument("--room", default="lib/sensor", choices=sorted(ROOMS))
    parser.add_argument("--tests")
    parser.add_argument("--extra", action="append", default=[])
    parser.add_argument("--slowest", type=float, default=10.0)
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--seed", type=int, default=16)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--least", type=float, default=95.0)
    parser.add_argument("--seconds", type=float, default=float("inf"))
    parser.add_argument("--kept", type=pathlib.Path)
    parser.add_argument("--sanitize", action="store_true")
    parser.add_argument("--excuses", type=pathlib.Path, default=HERE / "equivalent.txt")
    a = parser.parse_args()
    build = a.build.resolve()
    sources, tests = sources_of(build, a.room), tests_of(build, a.tests or ROOMS[a.room][1], a.extra)
    if not sources or not tests:
        sys.exit(f"mutants.py: {build} has {len(sources)} files of {a.room} and {len(tests)} tests")
    with tempfile.TemporaryDirectory(dir=build) as work:
        killed, survivors, equivalent, _ = run(sources, tests, a.count, a.seed, a.jobs, excuses(a.excuses),
                                               pathlib.Path(work), a.slowest, a.seconds, Kept(a.kept), a.sanitize)
    share = 100.0 * killed / max(1, killed + len(survivors))
    print(f"mutants.py: {a.room}: {killed} killed, {len(survivors)} survived, {len(equivalent)} more are equivalent: "
          f"{share:.1f} %")
    sys.exit(share < a.least)


if __name__ == "__main__":
    main()
