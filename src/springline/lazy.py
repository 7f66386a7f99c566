"""Packages whose names load when they are first used, so that `import springline` stays quick."""

from __future__ import annotations

import sys
from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping


def lazy_names(package: str, homes: Mapping[str, str]) -> Callable[[str], Any]:
    """Return the `__getattr__` of a package, which finds each name in its module of the package.

    Args:
        package: The package's `__name__`.
        homes: Module, relative to the package, by name.

    >>> lazy_names("springline.io", {"read": "reading"})("read").__module__
    'springline.io.reading'
    """

    def find(name: str) -> Any:
        if name not in homes:
            raise AttributeError(f"module '{package}' has no attribute '{name}'")
        value = getattr(import_module(f".{homes[name]}", package), name)
        setattr(sys.modules[package], name, value)
        return value

    return find


def call_as(package: str, name: str) -> None:
    """Make a package callable as its function `name`: once imported, it stands in `springline` under that very name."""

    class Package(ModuleType):
        def __call__(self, *args: Any, **options: Any) -> Any:
            return getattr(self, name)(*args, **options)

    sys.modules[package].__class__ = Package
