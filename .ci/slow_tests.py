"""The tests that take long, by a measurement: what tests/slow.txt says.

    python -m pytest -n 2 -m "" --junitxml=build/junit.xml
    python .ci/slow_tests.py build/junit.xml [build/junit-of-the-rest.xml ...] > tests/slow.txt

What tests share is counted with the first of them.  So the rest, ``-m "not slow"``, has to be
measured again with that list, and both measurements given.
"""

import argparse
import xml.etree.ElementTree as ElementTree
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
#: Longer tests than this are slow [s].
LONGEST = 1.2
#: Never slow: the same questions to every engine, the published walls, what the documentation
#: shows, what guards the repository, and kernels, whose quick tests also run interpreted.
KEPT = (
    "tests/engines/test_conformance",
    "tests/validation/test_published_walls.py",
    "tests/test_documentation.py",
    "tests/test_examples.py",
    "tests/test_repository.py",
    "tests/unit/test_kernels_",
)
HEAD = f"""\
# Tests that took longer than {LONGEST:g} s, which tests/conftest.py marks `slow`.
# Made by .ci/slow_tests.py; not to be edited by hand.
"""


def name_of(case: ElementTree.Element) -> str:
    """How pytest names the test of an entry: file, class, function and parameters."""
    parts = case.get("classname", "").split(".")
    for n in range(len(parts), 0, -1):
        file = Path(*parts[:n]).with_suffix(".py")
        if (ROOT / file).is_file():
            return "::".join([file.as_posix(), *parts[n:], case.get("name", "")])
    raise SystemExit(f"{'.'.join(parts)} is in no file of this folder.")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("junit", type=Path, nargs="+", help="what pytest --junitxml wrote")
    files = parser.parse_args().junit
    cases = [case for file in files for case in ElementTree.parse(file).iter("testcase")]
    slow = {name_of(case) for case in cases if float(case.get("time", "0")) > LONGEST}
    print(HEAD + "\n".join(sorted(name for name in slow if not name.startswith(KEPT))))


if __name__ == "__main__":
    main()
