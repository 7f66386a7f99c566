"""Run benchmarks: `python -m bench` all of them, `python -m bench fits` one."""

from __future__ import annotations

import argparse
import importlib
import pkgutil

import bench


def main() -> None:
    names = sorted(module.name for module in pkgutil.iter_modules(bench.__path__) if not module.name.startswith("_"))
    parser = argparse.ArgumentParser(prog="python -m bench", description=bench.__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"of {', '.join(names)}; all when none is given")
    wanted = parser.parse_args().names or names
    for name in wanted:
        if name not in names:
            parser.error(f"no benchmark is called {name!r}; there are {', '.join(names)}")
    for name in wanted:
        importlib.import_module(f"bench.{name}").main()


if __name__ == "__main__":
    main()
