"""The runner of mutants with a small C file of which it is known what becomes of each mutation."""
import pathlib
import sys
import tempfile

import mutants
import mutations

CODE = """\
#define LIMIT 10
static int calls;

/* 1 + 1 < 3: not code */
int limited(short x)
{
    int unused[4] = {0};
    calls = calls + 1;
    if (x > LIMIT)
        return 10;
    while (x < 0)
        x += 1;
    return x < LIMIT ? x : LIMIT;
}
"""
# x > 10 and x >= 10 are the same here, and nobody looks at calls. A loop without its step never ends. The lesser of two
# is the same with <=, which is not tried.
TEST = """\
int limited(short x);
int main(void)
{
    return !(limited(3) == 3 && limited(11) == 10 && limited(10) == 10 && limited(9) == 9 && limited(-2) == 0);
}
"""
KNOWN = {  # kind, line, before, after: verdict
    ("constant", 1, "10", "11"): "failed",
    ("constant", 1, "10", "9"): "survived",  # 10 gives 10 all the same
    ("operator", 8, "+", "-"): "survived",
    ("constant", 8, "1", "2"): "survived",
    ("constant", 8, "1", "0"): "survived",
    ("deletion", 8, "calls = calls + 1", ""): "survived",
    ("condition", 9, "x > LIMIT", "!(x > LIMIT)"): "failed",
    ("comparison", 9, ">", ">="): "survived",
    ("return", 10, "10", "0"): "failed",
    ("constant", 10, "10", "11"): "failed",
    ("constant", 10, "10", "9"): "failed",
    ("condition", 11, "x < 0", "!(x < 0)"): "failed",
    ("comparison", 11, "<", "<="): "failed",
    ("constant", 11, "0", "1"): "failed",
    ("operator", 12, "+=", "-="): "failed",
    ("constant", 12, "1", "2"): "survived",  # -2 goes to 0
    ("constant", 12, "1", "0"): "timed out",
    ("deletion", 12, "x += 1", ""): "timed out",
    ("return", 13, "x < LIMIT ? x : LIMIT", "0"): "failed",
    ("constant", 7, "0", "1"): "survived",
}
EXCUSED = "small.c: > -> >= in: if (x > LIMIT)"


def main():
    mutants.SHORTEST_LIMIT_S = 1.0
    wrong = []
    with tempfile.TemporaryDirectory() as name:
        work = pathlib.Path(name)
        (work / "small.c").write_text(CODE)
        (work / "test.c").write_text(TEST)
        flags = ["-O0", "-fwrapv", "-w"]
        source = mutants.Source(work / "small.c", "small.c", ["cc", *flags, "-o", "OBJECT", "-c", "SOURCE"])
        test = mutants.Test("small", ["cc", *flags, "-o", "PROGRAM", "OBJECT", "test.c"], ["PROGRAM"], work,
                            work / "test.c")
        (work / "equivalent.txt").write_text(EXCUSED + " # both give 10\n")
        excused = mutants.excuses(work / "equivalent.txt")
        killed, survivors, equivalent, verdicts = mutants.run([source], [test], 1000, 1, 2, excused, work)
        said = {(m.kind, mutations.line_of(CODE, m), " ".join(m.before.split()), m.after): v for _, m, v in verdicts}
        for key in KNOWN.keys() | said.keys():
            expected, verdict = KNOWN.get(key), said.get(key)
            if expected is None or verdict is None or verdict.removeprefix("small ") != expected:
                wrong.append(f"{key}: {verdict}, expected {expected}")
        dead = sum(v != "survived" for v in KNOWN.values())
        if (killed, len(equivalent), len(survivors)) != (dead, 1, len(KNOWN) - dead - 1):
            wrong.append(f"{killed} killed, {survivors} survived, {equivalent} equivalent")
        if source.compiled(CODE, work / "a.o") != source.compiled(CODE + "/* */", work / "b.o"):
            wrong.append("the same code is taken for another one")
        if mutants.drawn([source], 1) != mutants.drawn([source], 1):
            wrong.append("the same seed draws other mutants")
    for line in wrong:
        print("test_runner.py:", line)
    sys.exit(bool(wrong))


if __name__ == "__main__":
    main()
