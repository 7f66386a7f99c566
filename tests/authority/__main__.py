"""python -m tests.authority FILE.json ...: run vector files against the public functions."""

from __future__ import annotations

import sys

from tests.authority.runner import run


def main(paths):
    if not paths:
        print("usage: python -m tests.authority FILE.json ...", file=sys.stderr)
        return 2
    passed, failures = 0, []
    for path in paths:
        here, faults = run(path)
        passed += here
        failures += faults
    for line in failures:
        print(line)
    print(f"{passed} passed, {len(failures)} failed")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
