"""Which library is loaded, and which are refused."""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

import check

SHARED = pathlib.Path(os.environ["PUPIL_SHARED_LIBRARY"]).resolve()
MODULE = pathlib.Path(os.environ["PYTHONPATH"]) / "pupil_ae"
SAY = "import pupil_ae; print(pupil_ae.__version__, pupil_ae._library.lib._name)"
version = ".".join(SHARED.name.rsplit(".so.", 1)[1].split("."))


def run(folder, **environment):
    clean = {name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "PUPIL_LIBRARY")}
    return subprocess.run([sys.executable, "-c", SAY], cwd=folder, env={**clean, **environment}, text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT)


with tempfile.TemporaryDirectory() as folder:
    work = pathlib.Path(folder)
    here = run(work, PYTHONPATH=str(MODULE.parent))
    check.that(here.returncode == 0 and here.stdout.startswith(version), here.stdout)

    # moved away from its library
    shutil.copytree(MODULE, work / "moved" / "pupil_ae", ignore=shutil.ignore_patterns("__pycache__"))
    moved = str(work / "moved")
    given = run(work, PYTHONPATH=moved, PUPIL_LIBRARY=str(SHARED))
    check.that(given.returncode == 0 and str(SHARED) in given.stdout, given.stdout)
    lost = run(work, PYTHONPATH=moved, LD_LIBRARY_PATH="")
    if lost.returncode: # else another pupil is installed
        check.that("pupil_ae does not find libpupil.so" in lost.stdout and "PUPIL_LIBRARY" in lost.stdout, lost.stdout)
    other = run(work, PYTHONPATH=moved, PUPIL_LIBRARY="libc.so.6")
    check.that("ImportError: libc.so.6 has no pupil_" in other.stdout, other.stdout)

    # made for another version, and with a field at another offset than in the library
    abi = work / "moved" / "pupil_ae" / "_abi.py"
    text = abi.read_text()
    for old, new, words in (("VERSION = (0, 2, 0)", "VERSION = (0, 3, 0)", f"its version is {version}"),
                            ("('order', c_uint32),", "('order', c_uint64),", "dither is not where it should be"),
                            ("('rows', c_uint32),", "('rows', c_uint64),", "pupil_stats differs"),
                            ("('frames', c_uint64),", "('frames', c_uint32),", "pupil_exposure differs"),
                            ("('knees', c_uint32),", "('knees', c_uint64),", "knee_light is not where it should be")):
        check.that(old in text, f"{old} is not in _abi.py")
        abi.write_text(text.replace(old, new, 1))
        wrong = run(work, PYTHONPATH=moved, PUPIL_LIBRARY=str(SHARED))
        check.that(wrong.returncode and "ImportError: this pupil_ae was made for libpupil" in wrong.stdout
                   and words in wrong.stdout, wrong.stdout)
check.end()
