"""Which file needs which, and whether it may: see rooms.sh.

    rooms.py [--root TREE] [BUILD]    lists what is against the rules, exits with 1 if anything is
    rooms.py [--root TREE] --list     prints which folder includes which

With a BUILD of the tree, also circles of the files' calls to one another, from the symbols of its objects.
"""
import argparse
import pathlib
import re
import subprocess
import sys

TREE = pathlib.Path(__file__).resolve().parents[2]
# Where headers are searched, in this order, after the folder of the including file.
ROOTS = ("lib/include", "drivers/include", "lib", "drivers", "apps", "fixtures", "tests", "drivers/v4l2/controls")
GENERATED = {"gles_shader_texts.h", "camera_sensor_text.h"}
INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*(?:"([^"]+)"|<(pupil/[^>]+)>)', re.M)

# What each top-level folder may include, besides itself and the public headers of lib.
HOUSES = {
    "lib": (),
    "fixtures": (),
    "drivers": (),
    "apps": ("drivers", "fixtures"),
    "tests": ("drivers", "apps", "fixtures", "docs"),
    "docs": ("drivers",),  # examples
}
SOURCES_OF_SCENES = ("drivers/synth",)  # the one folder of drivers that sees fixtures
# What the rooms of lib may include, besides themselves and the public headers.
LIB = {
    "include": (),
    "base": (),
    "kernels": ("base",),
    "flicker": ("base",),
    "core": ("base", "kernels", "flicker"),
    "row_gain": ("base", "core"),
    "veil": ("base", "kernels", "core"),
    "look": ("base", "core"),
    "sensor": ("base", "core", "flicker"),
    "gles": ("base", "core"),
}
# Tests of internals: the table of kernels, the GPU's programs, instructions, sizes of objects.
INSIDE = {"tests/base": "lib", "tests/kernels": "lib", "tests/gles": "lib", "tests/arm": "lib", "tests/abi": "lib",
          "tests/fixtures": "fixtures"}

# apps know live cameras, and for one kind the names that --format takes.
KIND_OF_CAMERA = ("drivers/v4l2/", "drivers/libcamera/")
NAMES_OF_FORMATS = ("drivers/v4l2/format.h",)

# Known faults that are to be removed, as printed. A line that is no longer true is a fault, too.
KNOWN = ()


def files_of(root):
    if (root / ".git").exists():
        names = subprocess.run(["git", "ls-files", "--cached", "--others", "--exclude-standard"], cwd=root, text=True,
                               stdout=subprocess.PIPE, check=True).stdout.splitlines()
    else:
        names = [str(f.relative_to(root)) for f in root.rglob("*")]
    return sorted(n for n in names if re.search(r"\.(c|h|[ch]pp)$", n) and n.split("/")[0] in HOUSES
                  and (root / n).is_file())


def folder(name):
    return name.rsplit("/", 1)[0]


def resolve(name, included, files):
    for place in (folder(name),) + ROOTS:
        parts = []
        for part in f"{place}/{included}".split("/"):
            parts = parts[:-1] if part == ".." else parts + [part]
        path = "/".join(parts)
        if path in files:
            return path
    return None


def includes(root):
    """[(file, file that it includes)], and includes of missing files."""
    files = files_of(root)
    known = set(files)
    pairs, missing = [], []
    for name in files:
        for match in INCLUDE.finditer((root / name).read_text(errors="replace")):
            included = match.group(1) or match.group(2)
            path = resolve(name, included, known)
            if path:
                pairs.append((name, path))
            elif included not in GENERATED:
                missing.append(f"{name} includes {included}, which is not in the tree")
    return pairs, missing


def is_public(name):
    return name.startswith("lib/include/")


def crossing(name, included):
    """Why a file may not include another one, or None."""
    here, there = name.split("/"), included.split("/")
    if INSIDE.get(room(name)) == there[0]:
        return None
    if included.endswith("_private.h") and folder(name) != folder(included):
        return "a private header of another folder"
    if here[0] == there[0] == "lib":
        if here[1] != there[1] and not is_public(included) and there[1] not in LIB.get(here[1], ()):
            return f"lib/{here[1]} does not see lib/{there[1]}"
        return None
    if here[0] == there[0] or is_public(included):
        return None
    if there[0] == "lib":
        return "not a public header of the library"
    if there[0] == "fixtures" and name.startswith(SOURCES_OF_SCENES):
        return None
    if here[0] == "apps" and included.startswith(KIND_OF_CAMERA) and included not in NAMES_OF_FORMATS:
        return "cameras are reached through drivers/live"
    return None if there[0] in HOUSES[here[0]] else f"{here[0]} does not see {there[0]}"


def circles(edges):
    """The strongly connected components (Tarjan) of two nodes or more."""
    graph = {}
    for a, b in edges:
        if a != b:
            graph.setdefault(a, set()).add(b)
            graph.setdefault(b, set())
    number, low, stack, found = {}, {}, [], []

    def visit(node):
        number[node] = low[node] = len(number)
        stack.append(node)
        for other in sorted(graph[node]):
            if other not in number:
                visit(other)
            if other in stack:
                low[node] = min(low[node], low[other])
        if low[node] == number[node]:
            group = stack[stack.index(node):]
            del stack[stack.index(node):]
            if len(group) > 1:
                found.append(" - ".join(sorted(group)))

    for node in sorted(graph):
        if node not in number:
            visit(node)
    return found


def room(name):
    """The second level: drivers/v4l2 of drivers/v4l2/capture/capture.h."""
    return "/".join(folder(name).split("/")[:2])


def calls(root, build):
    """[(file, file with a symbol that it needs)], without suffixes."""
    defined, needed = {}, []
    for path in sorted(build.glob("*/**/CMakeFiles/*.dir/**/*.o")):
        place, source = str(path.relative_to(build)).split("/CMakeFiles/", 1)
        if place.split("/")[0] not in ("lib", "drivers", "apps", "fixtures"):
            continue
        parts = place.split("/")
        for part in source.split("/")[1:]:
            parts = parts[:-1] if part == "__" else parts + [part]  # CMake's word for ..
        name = "/".join(parts).split(".")[0]
        if not (root / f"{name}.c").is_file() and not (root / f"{name}.cpp").is_file():
            continue  # from an earlier build
        listed = subprocess.run(["nm", "-P", path], text=True, stdout=subprocess.PIPE, check=True).stdout
        for line in listed.splitlines():
            symbol, kind = line.split()[:2]
            if kind in "TDBRC":
                defined[symbol] = name
            elif kind == "U":
                needed.append((name, symbol))
    return [(name, defined[symbol]) for name, symbol in needed if symbol in defined]


def faults(root, build):
    pairs, found = includes(root)
    if not pairs:
        found.append(f"no includes in {root}")
    for name, included in pairs:
        why = crossing(name, included)
        if why:
            found.append(f"{name} -> {included}: {why}")
    for what, of in (("rooms", room), ("folders", folder), ("files", str)):
        for circle in circles((of(a), of(b)) for a, b in pairs):
            found.append(f"circle of {what}: {circle}")
    if build:
        pairs = calls(root, build)
        if not pairs:
            found.append(f"no objects in {build}")
        for what, of in (("rooms", room), ("folders", folder), ("files", str)):
            for circle in circles((of(a), of(b)) for a, b in pairs):
                found.append(f"circle of calls between {what}: {circle}")
    return sorted(set(found))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--root", type=pathlib.Path, default=TREE)
    parser.add_argument("build", type=pathlib.Path, nargs="?")
    parser.add_argument("--list", action="store_true")
    arguments = parser.parse_args()
    sys.setrecursionlimit(10000)
    if arguments.list:
        pairs = {(folder(a), folder(b)) for a, b in includes(arguments.root)[0]}
        print("\n".join(f"{a} -> {b}" for a, b in sorted(pairs) if a != b))
        return 0
    found = faults(arguments.root, arguments.build)
    excused = [k for k in KNOWN if arguments.root == TREE and (arguments.build or "circle of calls" not in k)]
    gone = [k for k in excused if k not in found]
    new = [f for f in found if f not in excused]
    for fault in new:
        print(f"rooms.py: {fault}")
    for fault in gone:
        print(f"rooms.py: no longer there, to be taken from KNOWN: {fault}")
    print(f"rooms.py: {len(new)} faults, {len(found) - len(new)} known")
    return 1 if new or gone else 0


if __name__ == "__main__":
    sys.exit(main())
