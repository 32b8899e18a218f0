"""The scripts of docs/examples that only need numpy, and the Python block in docs/guide.md: each runs, and is short.
picamera2_loop.py runs with the module of tests/python/fake."""
import math
import os
import pathlib
import re
import subprocess
import sys
import tempfile

import check

SOURCE = pathlib.Path(os.environ["PUPIL_SOURCE_DIR"])
EXAMPLES = SOURCE / "docs" / "examples"


def run(script, *arguments, **environment):
    with tempfile.TemporaryDirectory() as folder:
        ended = subprocess.run([sys.executable, script, *arguments], cwd=folder, text=True, stdout=subprocess.PIPE,
                               stderr=subprocess.STDOUT, env={**os.environ, **environment})
    check.that(ended.returncode == 0, f"{script} fails: {ended.stdout}")
    return ended.stdout


for path in EXAMPLES.glob("*.py"):
    check.that(len(path.read_text().splitlines()) <= 40, f"{path.name} is longer than 40 lines")
check.that(len((EXAMPLES / "numpy_frames.py").read_text().splitlines()) <= 30, "numpy_frames.py is too long")

said = run(EXAMPLES / "numpy_frames.py")
adapted = [float(number) for number in re.findall(r"adapted ([-+.\d]+) EV", said)]
check.that(len(adapted) == 6 and abs(adapted[-1] - adapted[1] - 3) < 0.05, said)
check.that("(270, 480, 3) uint8 (270, 480, 3) float32 0.0" in said, said)

# Light for which the camera's first setting, 10 ms, is 2 stops off; it rises eightfold, and the loop follows.
said = run(EXAMPLES / "picamera2_loop.py", "150", PUPIL_FAKE_LIGHT="9",
           PYTHONPATH=f"{SOURCE}/tests/python/fake:{os.environ['PYTHONPATH']}")
shown = float(re.search(r"fake: stopped True, shown ([.\d]+)", said).group(1))
check.that(abs(math.log2(shown / 0.18)) < 0.25, said[-2000:])
check.that(said.count("\n") == 151 and "converged" in said, said[-2000:])

blocks = re.findall(r"```python\n(.*?)```", (SOURCE / "docs" / "guide.md").read_text(), re.S)
check.that(len(blocks) == 1, f"{len(blocks)} blocks of Python in docs/guide.md")
with tempfile.NamedTemporaryFile("w", suffix=".py") as file:
    file.write(blocks[0])
    file.flush()
    run(file.name)
check.end()
