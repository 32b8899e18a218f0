"""Words of the tree: see words.sh. The retired words are those of the last table of docs/glossary.md."""
import argparse
import pathlib
import re
import statistics
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
EXCUSES = HERE / "words_excused.txt"
GLOSSARY = HERE.parent.parent / "docs" / "glossary.md"
BINARY = {".png", ".jpg", ".exr", ".ico"}
# A home or scratch folder. Templates of mkstemp and mkdtemp, which end in six X, are allowed.
MACHINE_PATH = re.compile(r"(?<![\w$}.)-])/(?:root|home|Users|work|tmp|mnt)/(?![\w.@-]*(?:XXXXXX|\.\.\.))[\w.@-]+")
ROOMS = ("lib", "drivers", "apps", "fixtures", "tests", "cmake", "docs")
HOUSES = ("apps/", "drivers/", "lib/")  # where strings are help or messages
SHORTEST_SENTENCE = 4  # words; a shorter string is a label
LONG_SENTENCE = 35


def files_of(root):
    if (root / ".git").exists():
        names = subprocess.run(["git", "ls-files"], cwd=root, text=True, stdout=subprocess.PIPE, check=True).stdout
        files = [root / name for name in names.splitlines()]
    else:
        files = [f for f in root.rglob("*") if not f.relative_to(root).parts[0].startswith(("build", "."))]
    return sorted(f for f in files if f.is_file() and f.suffix not in BINARY)


def retired_words():
    """The forms in backquotes of the table under "Retired words"."""
    table = GLOSSARY.read_text().split("\n## Retired words", 1)[1]
    rows = [line.split("|") for line in table.splitlines() if line.startswith("|")]
    forms = [form for row in rows for form in re.findall(r"`([^`]+)`", row[3])]
    if len(forms) < 20:
        sys.exit("words.py: the table of retired words in docs/glossary.md cannot be read")
    forms.sort(key=len, reverse=True)
    # not part of a name: object.flicker, flicker_ev
    return re.compile(r"(?<![\w.])(" + "|".join(r"\s+".join(f.split()) for f in forms) + r")(?!\w|-)(?!\s*=)", re.I)


# What is prose, as (line, text) pieces.


def of_c(text, comments):
    """Comments of a C file, or its strings; adjacent ones are joined."""
    token = re.compile(r'/\*.*?\*/|//[^\n]*|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\'', re.S)
    pieces, end = [], -1
    for m in token.finditer(text):
        t, line = m[0], text.count("\n", 0, m.start()) + 1
        if t[0] == "/" and comments and not re.match(r"/\* -{3}", t):
            body = re.sub(r"\n[ \t]*\*?", "\n", t.strip("/").strip("*"))
            # A paragraph is a piece; so are the lines of a table in a comment.
            pieces += [(line, p) for p in re.split(r"\n\s*\n|\n {3,}|\n - ", body)]
        if t[0] == '"' and not comments:
            if end >= 0 and text[end : m.start()].strip(" \n\t\\") == "":
                pieces[-1] = (pieces[-1][0], pieces[-1][1] + t[1:-1])
            else:
                pieces.append((line, t[1:-1]))
        if t[0] == '"' or t[0] == "/" and text[end : m.start()].strip(" \n\t\\") == "":
            end = m.end()
    return pieces if comments else [(n, t.replace("\\n", "\n")) for n, t in pieces if re.search(r"\s", t)]


def of_markdown(text, cells):
    text = text.split("\n## Retired words", 1)[0]
    pieces, paragraph, fenced, start = [], [], False, 0
    for number, line in enumerate(text.splitlines() + [""], 1):
        if line.startswith("```"):
            fenced = not fenced
        code = fenced or line.startswith(("    ", "```")) and not paragraph
        item = re.match(r"\s*([-*]|\d+\.) ", line)
        if not line.strip() or code or item or line.startswith(("|", "#", "!")):
            if paragraph:
                pieces.append((start, "\n".join(paragraph)))
            paragraph = []
        if line.startswith("|") and cells:
            pieces += [(number, cell) for cell in line.strip("|").split("|")]
        elif line.strip() and not code and not line.startswith(("#", "!", "|")):
            start = start if paragraph else number
            paragraph.append(line[item.end() :] if item else line)
    pieces = [(n, re.sub(r"`[^`]*`", "`x`", t)) for n, t in pieces]
    return [(n, re.sub(r"\]\([^)]*\)|[\[\]*]", "", t)) for n, t in pieces]


def of_manual(text):
    lines = [(n, re.sub(r"\\f[BIRP]|\\", "", line)) for n, line in enumerate(text.splitlines(), 1)]
    pieces, example = [], False
    for n, line in lines:
        example = (example or line.startswith((".EX", ".nf"))) and not line.startswith((".EE", ".fi"))
        if line.startswith(".") or example:
            pieces.append((n, ""))
        elif pieces and pieces[-1][1]:
            pieces[-1] = (pieces[-1][0], pieces[-1][1] + "\n" + line)
        else:
            pieces.append((n, line))
    return pieces


def prose(name, text, all_comments):
    """To be refused; or, with all_comments, to be measured: comments of all files, no strings, no cells of tables."""
    if name.endswith(".md"):
        return of_markdown(text, not all_comments)
    if re.search(r"\.\d$", name):
        return of_manual(text)
    if not name.endswith((".c", ".h", ".cpp", ".hpp")):
        return []
    pieces = of_c(text, True) if all_comments or is_public(name) else []
    if name.startswith(HOUSES) and not all_comments:
        pieces += of_c(text, False)
    return pieces


def is_public(name):
    return name.startswith(("lib/include/", "drivers/include/")) or name in ("drivers/source.h", "drivers/sink.h")


# The test.


def excuses():
    """PATH: WORD: REASON, one a line; PATH may be a folder (with /), WORD may be *."""
    table = []
    for line in EXCUSES.read_text().splitlines():
        if line and not line.startswith("#"):
            path, word, reason = (part.strip() for part in line.split(":", 2))
            table.append({"path": path, "word": word, "reason": reason, "used": False})
    return table


def is_excused(table, name, word):
    for e in table:
        if (name == e["path"] or e["path"].endswith("/") and name.startswith(e["path"])) and e["word"] in (word, "*"):
            e["used"] = True
            return True
    return False


def missing_files(root, name, text):
    """Missing files that a document links to or names as `folder/file`."""
    folder = (root / name).parent
    links = [(m.start(), folder / m[1]) for m in re.finditer(r"\]\((?!http)([^)#]+)[^)]*\)", text)]
    paths = [(m.start(), root / m[0]) for m in re.finditer(r"(?<![\w/.])(?:%s)/[\w/.-]*\w" % "|".join(ROOMS), text)]
    return [f"{name}:{text.count(chr(10), 0, at) + 1}: {path.relative_to(root)} is not there"
            for at, path in links + paths if not path.exists()]


def missing_functions(root, name, text):
    """Functions that a document names, as `folder/file.c: first, second`, and that are not in that file."""
    faults = []
    for m in re.finditer(r"`([\w/.-]+\.[ch]): ([\w, ]+)`", text):
        source = (root / m[1]).read_text() if (root / m[1]).exists() else ""
        for function in m[2].split(", "):
            if not re.search(rf"\b{function}\(", source):
                faults.append(f"{name}:{text.count(chr(10), 0, m.start()) + 1}: {m[1]} has no function {function}")
    return faults


def check(root):
    retired, table, faults = retired_words(), excuses(), []
    for file in files_of(root):
        name = file.relative_to(root).as_posix()
        try:
            text = file.read_text()
        except UnicodeDecodeError:
            continue
        for number, line in enumerate(text.splitlines(), 1):
            for m in MACHINE_PATH.finditer(line):
                if not is_excused(table, name, m[0]):
                    faults.append(f"{name}:{number}: {m[0]}: a path of one machine")
        if name.endswith(".md"):
            faults += missing_files(root, name, text) + missing_functions(root, name, text)
        for number, piece in prose(name, text, False):
            for m in retired.finditer(piece):
                word = " ".join(m[0].lower().split())
                if not is_excused(table, name, word):
                    at = number + piece.count("\n", 0, m.start())
                    around = " ".join(piece[max(0, m.start() - 30) : m.end() + 30].split())
                    faults.append(f"{name}:{at}: '{word}' is retired (docs/glossary.md): ... {around} ...")
    faults += [f"words_excused.txt: {e['path']}: {e['word']} excuses nothing, take it off" 
               for e in table if not e["used"] and e["word"] != "*"]
    print("\n".join(faults + [f"{len(faults)} faults"]))
    return 1 if faults else 0


PLANTED = (  # (file, text, retired words and machine paths in it)
    ("lib/core/a.c", 'say("it was " /* told */\n    "told"); judge("told", x->lies);', ["told"]),
    ("lib/include/pupil/a.h", "/* What lies\n * beside it */ int told; /* config.flicker */", ["lies", "beside"]),
    ("docs/a.md", "Goes\non `told`\n\n    told\n\n| by | done by hand |\n\n```\nanew\n```\n", ["goes on", "by hand"]),
    ("docs/a.1", ".B told\nbut for it\n.EX\nanew\n.EE\n", ["but for"]),
    ("tests/a.c", "/* told */ x = \"/home" + "/me/x\"; y = \"/tmp/pupil-XXXXXX\";", ["/home" + "/me"]),
    ("tests/a.sh", "$w/root/bin ${w}/root/bin ./work/bin", []),
)


def check_planted():
    """Checks that the check can fail: 1 if a planted word is not found, or another one is."""
    retired, faults = retired_words(), 0
    for name, text, words in PLANTED:
        found = [" ".join(m[0].lower().split()) for _, p in prose(name, text, False) for m in retired.finditer(p)]
        found += MACHINE_PATH.findall(text)
        if found != words:
            print(f"planted in {name}: {words}, found: {found}")
            faults = 1
    planted = "[x](none.md) lib/none.c [y](glossary.md#x) docs/glossary.md"
    missing = missing_files(GLOSSARY.parent.parent, "docs/a.md", planted)
    if len(missing) != 2:
        print(f"planted in docs/a.md: two missing files, found: {missing}")
        faults = 1
    planted = "`lib/core/pupil.c: pupil_init, none` `lib/none.c: x`"
    missing = missing_functions(GLOSSARY.parent.parent, "docs/a.md", planted)
    if len(missing) != 2:
        print(f"planted in docs/a.md: two missing functions, found: {missing}")
        faults = 1
    return faults


# The figures.


def sentences(piece):
    for s in re.split(r"(?<=[.!?])[\"')]*\s+(?=[A-Z0-9`(\"])", piece):
        words = [w for w in s.split() if re.search(r"\w", w)]
        if len(words) >= SHORTEST_SENTENCE:
            yield len(words), s


def room_of(name):
    parts = name.split("/")
    if is_public(name):
        return "public headers"
    if parts[0] == "docs" or len(parts) == 1:
        return "docs"
    return "/".join(parts[:2]) if parts[0] in ("lib", "drivers", "apps") and len(parts) > 2 else parts[0]


def figures(root, pages):
    retired, rooms = retired_words(), {}
    for file in files_of(root):
        name = file.relative_to(root).as_posix()
        if name in ("lib/include/pupil/sensor.h", "docs/glossary.md"):
            continue  # the sensor's header is treated separately; the glossary has the words
        if not name.endswith((".c", ".h", ".cpp", ".hpp", ".md")) and not re.search(r"\.\d$", name):
            continue
        room = name if pages and name.endswith((".md", ".1")) else room_of(name)
        for _, piece in prose(name, file.read_text(), True):
            rooms.setdefault(room, []).extend((n, bool(retired.search(s))) for n, s in sentences(piece))
    print(f"{'room':24} {'sentences':>9} {'median':>6} {'p90':>4} {'over 35':>8} {'retired':>8}")
    every = [s for room in rooms.values() for s in room]
    for room, found in sorted(rooms.items()) + [("all", every)]:
        if found:
            lengths = sorted(n for n, _ in found)
            long = sum(n > LONG_SENTENCE for n in lengths) / len(found)
            old = sum(r for _, r in found) / len(found)
            print(f"{room:24} {len(found):9} {statistics.median(lengths):6.0f} {lengths[len(found) * 9 // 10]:4} "
                  f"{100 * long:7.1f}% {100 * old:7.1f}%")
    return 0


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("--figures", action="store_true")
    arguments.add_argument("--pages", action="store_true", help="with --figures: each document by itself")
    arguments.add_argument("--root", type=pathlib.Path, default=HERE.parent.parent)
    a = arguments.parse_args()
    sys.exit(figures(a.root, a.pages) if a.figures else check_planted() or check(a.root))


main()
