"""For the tests of the module: counts checks that hold and those that fail."""
import sys

try:
    import numpy  # noqa: F401
except ImportError:
    print("skipped: no python3-numpy")
    sys.exit(77)

_counts = {"checks": 0, "failed": 0}


def that(holds, what):
    _counts["checks"] += 1
    if not holds:
        _counts["failed"] += 1
        print(f"FAILED, line {sys._getframe(1).f_lineno}: {what}")


def raises(kind, words, call, *arguments, **keywords):
    """The call raises exactly this kind, with these words in its text."""
    _counts["checks"] += 1
    try:
        result = call(*arguments, **keywords)
        said = f"it returned {result!r}"
    except Exception as error:
        if type(error) is kind and words in str(error):
            return
        said = repr(error)
    _counts["failed"] += 1
    print(f"FAILED, line {sys._getframe(1).f_lineno}: {kind.__name__} with {words!r} was expected: {said}")


def end():
    print(f"{_counts['checks']} checks, {_counts['failed']} failed")
    sys.exit(_counts["failed"] > 0 or not _counts["checks"])
