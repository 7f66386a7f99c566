"""The survey itself: groups of named arrays that stages read and add to."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import xarray as xr

from ..conventions import GROUPS, SOURCE_GROUPS
from ..errors import ContractError, MissingGroupError, nearest

if TYPE_CHECKING:
    from collections.abc import Mapping

PENDING = "overrides_pending"
"""Attribute of corrections that were read beside a finished survey and wait for the next inspection."""


class Survey:
    """A pipe survey: source groups as read, result groups as added by the stages.

    A survey is never changed in place: `with_group` returns a new one that shares the old arrays. Groups, dims, units
    and frame are those of `springline.conventions.GROUPS`; each group is an attribute (`survey.rings`).

    Args:
        groups: Datasets by group name.
        attrs: Root attributes, as `conventions.ROOT_ATTRIBUTES` lists them.

    Raises:
        ContractError: A group is unknown.

    >>> import numpy as np
    >>> ring = xr.Dataset({"range": (("ring", "bearing"), np.full((1, 8), 0.15, "float32"))})
    >>> survey = Survey({"rings": ring}, {"name": "A to B"})
    >>> survey.rings.sizes["bearing"], survey.has("points")
    (8, False)
    """

    def __init__(self, groups: Mapping[str, xr.Dataset], attrs: Mapping[str, Any] | None = None) -> None:
        for name in groups:
            if name not in GROUPS:
                raise ContractError(f"unknown group '{name}'{nearest(name, GROUPS)}", where="survey")
        self._groups = dict(groups)
        self._attrs = dict(attrs or {})

    @property
    def tree(self) -> xr.DataTree:
        """The survey as an `xarray.DataTree`."""
        tree = xr.DataTree.from_dict({f"/{name}": data for name, data in self._groups.items()})
        tree.attrs.update(self._attrs)
        return tree

    @property
    def attrs(self) -> dict[str, Any]:
        """A copy of the root attributes."""
        return dict(self._attrs)

    @property
    def groups(self) -> tuple[str, ...]:
        """Names of the groups that are there, in the order of the contract."""
        return tuple(name for name in GROUPS if name in self._groups)

    def has(self, name: str) -> bool:
        """Whether the group is there."""
        return name in self._groups

    def group(self, name: str) -> xr.Dataset:
        """Return a group.

        Raises:
            MissingGroupError: It is not there; the message names what makes it.
        """
        if name not in GROUPS:
            raise MissingGroupError(f"unknown group '{name}'{nearest(name, GROUPS)}", where="survey")
        if name not in self._groups:
            raise MissingGroupError(
                f"the group '/{name}' is not there",
                where="survey",
                mend=f"it is made by {GROUPS[name].made_by}",
            )
        return self._groups[name]

    def __getattr__(self, name: str) -> xr.Dataset:
        if name in GROUPS:
            return self.group(name)
        raise AttributeError(f"'Survey' object has no attribute '{name}'")

    def with_group(self, name: str, data: xr.Dataset) -> Survey:
        """Return a survey that has one group more.

        Raises:
            ContractError: The group is already there (nothing is overwritten) or is unknown.
        """
        if name in self._groups:
            raise ContractError(
                f"the group '/{name}' is already there and is never overwritten",
                where="survey",
                mend="start from Survey.source() to run the stages anew",
            )
        return Survey({**self._groups, name: data}, self._attrs)

    def corrected(self, name: str, data: xr.Dataset) -> Survey:
        """Return a survey in which a result is as people corrected it; only their overrides may replace a group."""
        return Survey({**self._groups, name: data}, self._attrs)

    def with_attrs(self, **attrs: Any) -> Survey:
        """Return a survey with root attributes set; None removes one."""
        merged = {**self._attrs, **attrs}
        return Survey(self._groups, {key: value for key, value in merged.items() if value is not None})

    def source(self) -> Survey:
        """Return what came from files alone, to run the stages anew: without warnings, and without what an earlier
        inspection assumed."""
        kept = {name: data for name, data in self._groups.items() if name in SOURCE_GROUPS}
        if kept.get("rings", xr.Dataset()).attrs.get("distance_source") == "axis" and "points" in kept:
            del kept["rings"]
        attrs = {key: value for key, value in self._attrs.items() if key != "warnings"}
        concluded = set(json.loads(attrs.get("provenance", "{}")).get("concluded", []))
        if concluded:
            attrs["assumptions"] = json.dumps([one for one in self.assumptions if one not in concluded])
        if PENDING in attrs:
            attrs["overrides"] = attrs.pop(PENDING)
        return Survey(kept, attrs)

    @property
    def warnings(self) -> list[str]:
        """What the user must know, in plain sentences."""
        return json.loads(self._attrs.get("warnings", "[]"))

    @property
    def assumptions(self) -> list[str]:
        """What was assumed while reading, in plain sentences."""
        return json.loads(self._attrs.get("assumptions", "[]"))

    @property
    def overrides(self) -> list[dict[str, str]]:
        """Corrections that people made: each with `action`, `what`, `author`, `date`, `reason` and, once an inspection
        has applied it, `effect`; all plain sentences or words."""
        return [
            {key: value for key, value in one.items() if key != "change"}
            for one in json.loads(self._attrs.get("overrides", "[]"))
        ]

    def __repr__(self) -> str:
        sizes = ", ".join(
            f"{name} ({', '.join(f'{d} {n}' for d, n in self._groups[name].sizes.items())})" for name in self.groups
        )
        return f"<Survey {self._attrs.get('name', 'without a name')}: {sizes or 'empty'}>"
