"""The functions of every vector file by name; one adapter module for each file.

A name that stands in two files (`conic_to_ellipse`) serves both here: its result holds the keys of either.
"""

from __future__ import annotations

from functools import wraps

from tests.authority import adapter_camera, adapter_pose, adapter_sections

MODULES = (adapter_sections, adapter_pose, adapter_camera)


def _joined(calls):
    """Return a function whose result has the keys of every call's result."""

    @wraps(calls[0])
    def call(**inputs):
        return {key: value for each in calls for key, value in each(**inputs).items()}

    return call


def _all():
    found = {}
    for module in MODULES:
        for name, function in module.FUNCTIONS.items():
            found.setdefault(name, []).append(function)
    return {name: calls[0] if len(calls) == 1 else _joined(calls) for name, calls in found.items()}


FUNCTIONS = _all()


def __getattr__(name):
    try:
        return FUNCTIONS[name]
    except KeyError:
        raise AttributeError(f"no adapter for {name!r}") from None
