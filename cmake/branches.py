"""Which branches of folders of the library or the drivers ran, of a build made with --coverage whose tests have run.

    branches.py BUILD FOLDER...     a table; with --missing also each line with a branch that did not run
    branches.py --unreached LIST BUILD FOLDER...    the table, and exit 1 unless the branches that did not run are those
                                    of LIST (tests/tree/branches.txt, which says how it is written)

A branch is one of gcov's: each way that a condition between && and || can go. Compiled without optimisation they are
those of the source.
"""
import json
import os
import pathlib
import re
import subprocess
import sys

TREE = pathlib.Path(__file__).resolve().parent.parent


# The kernels' other levels have no branches of their own to show: kernels.levels compares them byte by byte with the
# scalar one. Which of them run, and the ways of level.c, is decided by the machine's CPU: kernels.emulated.
OTHER_LEVELS = re.compile(r"/kernels/(avx2|avx512|level|neon|wasm128)\b")


def source_of(build, data):
    """Of CMake's drivers/v4l2/controls/CMakeFiles/pupil_camera.dir/__/__/live/live.c.gcda: drivers/live/live.c."""
    before, after = str(data.relative_to(build)).split("/CMakeFiles/")
    return os.path.normpath(f"{before}/{after.split('/', 1)[1].replace('__', '..')}".removesuffix(".gcda"))


def is_of(source, folder):
    """drivers/file has its folders' files, too; drivers, which has rooms, its own alone."""
    parent = os.path.dirname(source)
    return parent == folder or ("/" in folder and parent.startswith(folder + "/"))


def branches_of(build, folder):
    """{file: {line: [count of each branch]}}, and {file: [lines that ran, lines]}."""
    branches, lines = {}, {}
    for name in (build / folder.split("/")[0]).rglob("*.gcda"):
        if not is_of(source_of(build, name), folder) or OTHER_LEVELS.search(str(name)):
            continue
        said = subprocess.run(["gcov", "--json-format", "--stdout", "--branch-probabilities", name], cwd=build,
                              stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, check=True, text=True).stdout
        for file in json.loads(said)["files"]:
            path = pathlib.Path(build, file["file"]).resolve()
            if not path.is_relative_to(TREE) or not is_of(str(path.relative_to(TREE)), folder):
                continue
            known = branches.setdefault(str(path.relative_to(TREE)), {})
            ran = lines.setdefault(str(path.relative_to(TREE)), {})
            for line in file["lines"]:
                number = line["line_number"]
                ran[number] = ran.get(number, 0) + line["count"]
                counts = [b["count"] for b in line["branches"] if not b["throw"]]
                before = known.get(number, [0] * len(counts))
                if counts:  # a header's line is in several objects
                    known[number] = [a + b for a, b in zip(before, counts)]
    return branches, {name: [sum(c > 0 for c in ran.values()), len(ran)] for name, ran in lines.items()}


def text_of(name, number):
    return (TREE / name).read_text().splitlines()[number - 1].strip()


def read_list(path):
    """{(file, way, the line's text)}, and {folder or file: {word: what follows it}} of the other lines."""
    listed, rules = set(), {}
    for line in pathlib.Path(path).read_text().splitlines():
        if line.startswith(("lib/", "drivers/", "drivers: ")):
            name, word, text = line.split(": ", 2)
            if word.isdigit():
                listed.add((name, int(word), text))
            else:
                rules.setdefault(name, {})[word] = text
    return listed, rules


def check_list(path, found, shares, folders):
    """found: {folder: {(file, way, text) that did not run}}; shares: {folder: per cent that ran}. What is wrong, a line
    each."""
    listed, rules = read_list(path)
    faults = []
    for folder in folders:
        mine = {entry for entry in listed if is_of(entry[0], folder)}
        unlisted = found[folder] - mine
        if len(mine) > MOST_LISTED:
            faults.append(f"{folder}: {len(mine)} ways are listed, at most {MOST_LISTED} may be")
        faults += [f"{e[0]}: way {e[1]} ran, or is no more, but is listed: {e[2]}"
                   for e in sorted(mine - found[folder])]
        rule = rules.get(folder, {})
        if "at least" in rule:
            if shares[folder] < float(rule["at least"].split()[0]):
                faults.append(f"{folder}: {shares[folder]:.2f} % of its ways ran; at least {rule['at least']} must")
        elif len(unlisted) > int(rule.get("at most", 0)):
            faults += [f"{e[0]}: way {e[1]} did not run and is not listed: {e[2]}" for e in sorted(unlisted)]
    return faults


MOST_LISTED = 10
LIST = TREE / "tests/tree/branches.txt"


def main():
    arguments = [a for a in sys.argv[1:] if a != "--missing"]
    unreached = arguments[1] if arguments[:1] == ["--unreached"] else None
    arguments = arguments[2:] if unreached else arguments
    found, shares = {}, {}
    if len(arguments) < 2:
        sys.exit(__doc__)
    elsewhere = [name for name, rule in read_list(unreached or LIST)[1].items() if "elsewhere" in rule]
    print(" branches              lines")
    for folder in arguments[1:]:
        branches, lines = branches_of(pathlib.Path(arguments[0]).resolve(), folder)
        for name in set(branches) & set(elsewhere):
            print(f"{'':35}{name}: not counted, for it runs elsewhere")
            del branches[name]
        together = [0, 0, 0, 0]
        for name in sorted(branches):
            counts = [c for line in branches[name].values() for c in line]
            row = [sum(c > 0 for c in counts), len(counts), *lines[name]]
            together = [a + b for a, b in zip(together, row)]
            print(row_of(row, name))
        print(row_of(together, f"{folder} together"))
        shares[folder] = 100.0 * together[0] / max(1, together[1])
        found[folder] = set()
        for name in branches:
            for number, counts in branches[name].items():
                text, missing = text_of(name, number), [i + 1 for i, c in enumerate(counts) if not c]
                found[folder] |= {(name, way, text) for way in missing}
        if not together[1]:
            sys.exit(f"{folder}: no test of this build has run it")
        for name in sorted(branches) if "--missing" in sys.argv else ():
            for number, counts in sorted(branches[name].items()):
                if not all(counts):
                    ways = ", ".join(str(i + 1) for i, c in enumerate(counts) if not c)
                    print(f"{name}:{number}: of {len(counts)} ways not {ways}: {text_of(name, number)}")
    faults = check_list(unreached, found, shares, arguments[1:]) if unreached else []
    for fault in faults:
        print(fault)
    sys.exit(1 if faults else 0)


def row_of(row, name):
    shares = [100.0 * row[i] / max(1, row[i + 1]) for i in (0, 2)]
    return f"{shares[0]:6.2f} % of {row[1]:5}  {shares[1]:6.2f} % of {row[3]:5}  {name}"


if __name__ == "__main__":
    main()
