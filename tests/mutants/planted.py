"""Errors that are planted in the library one at a time, and which test finds each.

    planted.py ERRORS [--build BUILD] [--tests REGEX] [--extra "PROGRAM ARGUMENTS"]...

ERRORS is a text: of each error a line "== what it is", the file's name, and changes: lines that begin with "-" stand in
the file exactly once, and become those that begin with "+". A blank line lies between two changes. The tests and BUILD
are as mutants.py has them, and the extra ones come first. Exits with 1 where an error cannot be planted or is not
found.
"""
import argparse
import pathlib
import sys
import tempfile

import mutants


def errors_of(text):
    """[(name, file, [(before, after)])]"""
    found = []
    for block in text.split("\n== ")[1:]:
        name, file, *lines = block.rstrip().splitlines()
        changes = [[]]
        for line in lines:
            changes[-1].append(line) if line[:1] in "-+" and line else changes.append([])
        sides = [tuple("\n".join(t[1:] for t in c if t[0] == side) for side in "-+") for c in changes if c]
        found.append((name, file, sides))
    return found


def planted(text, changes):
    """The text with all changes, or a sentence why not."""
    for before, after in changes:
        if text.count(before) != 1:
            return None, f"{text.count(before)} times in the file: {before}"
        text = text.replace(before, after)
    return text, None


def run(errors, sources, tests, work):
    """Prints which test finds each; returns how many are not planted or not found."""
    by_name = {s.name: s for s in sources}
    missed = 0
    for name, file, changes in errors:
        text, fault = planted(by_name[file].text, changes) if file in by_name else (None, f"no {file}")
        obj = work / "planted.o"
        if text is not None and by_name[file].compiled(text, obj) is None:
            fault = "does not compile"
        said = f"NOT PLANTED: {fault}" if fault else mutants.judged(tests, obj, work)
        said = "NOT FOUND" if said == "survived" else said
        missed += said.startswith("NOT")
        print(f"{name}: {said}", flush=True)
    return missed


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("errors", type=pathlib.Path)
    parser.add_argument("--build", type=pathlib.Path, default=mutants.TREE / "build" / "dev")
    parser.add_argument("--tests", default=r"^sensor\.")
    parser.add_argument("--extra", action="append", default=[])
    a = parser.parse_args()
    build = a.build.resolve()
    errors = errors_of("\n" + a.errors.read_text())
    sources = mutants.sources_of(build, str(pathlib.Path(errors[0][1]).parent))
    tests = mutants.tests_of(build, a.tests, a.extra)
    with tempfile.TemporaryDirectory(dir=build) as name:
        work = pathlib.Path(name)
        sources[0].compiled(sources[0].text, work / "plain.o")
        tests = mutants.timed(tests, work / "plain.o", work, float("inf"))
        tests.sort(key=lambda t: t.name not in a.extra)
        missed = run(errors, sources, tests, work)
    print(f"planted.py: {len(errors) - missed} of {len(errors)} errors are found")
    sys.exit(missed > 0)


if __name__ == "__main__":
    main()
