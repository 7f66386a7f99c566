"""What the data contract is made of: a group, and a variable that stands in it."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Variable:
    """One variable of a group: its dims, unit, meaning and whether it must be there."""

    name: str
    dims: tuple[str, ...]
    unit: str
    description: str
    dtype: str = "float64"
    required: bool = False


@dataclass(frozen=True)
class Group:
    """One group of the data contract: what makes it, its variables and its attributes."""

    name: str
    made_by: str
    description: str
    variables: tuple[Variable, ...] = ()
    attributes: tuple[tuple[str, str], ...] = ()
    open: bool = False
    """Whether other variables than those listed may stand in it."""

    def variable(self, name: str) -> Variable:
        """Return the listed variable called `name`; KeyError when it is not listed."""
        return {v.name: v for v in self.variables}[name]


def var(name: str, dims: str, unit: str, description: str, dtype: str = "float64", required: bool = False) -> Variable:
    """Return a variable whose dims are written as one text, separated by spaces."""
    return Variable(name, tuple(dims.split()), unit, description, dtype, required)


def with_sigma(variables: tuple[Variable, ...], holds: str = ", fit and scale") -> tuple[Variable, ...]:
    """Return each variable followed by its one-sigma, which holds what `holds` says."""
    return tuple(
        one
        for v in variables
        for one in (v, Variable(f"{v.name}_sigma", v.dims, v.unit, f"one-sigma of {v.name}{holds}"))
    )
