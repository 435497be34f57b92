"""Short ways to follow a small model, and to compare its labels with a closed form."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import pytest

import contin
from contin.continuation.branch import Branch


def model(equations: Mapping[str, str], states: Mapping[str, object], parameters: Mapping[str, object], **parts):
    return contin.Model("case", states=dict(states), parameters=dict(parameters), equations=dict(equations), **parts)


def follow(
    equations: Mapping[str, str], states: Mapping[str, object], parameters: Mapping[str, object],
    range: tuple[float, float], parts: Mapping[str, object] | None = None, **options,
) -> Branch:  # fmt: skip
    """The branch of equilibria through `states` while the first parameter varies."""
    start = contin.equilibrium(model(equations, states, parameters, **(parts or {})))
    return contin.continuation(start, next(iter(parameters)), range, **options)


def labels(branch: Branch, types: str = "LP BP HB PD NS") -> list[tuple[str, float]]:
    """(type, parameter) of the labelled points in row order."""
    return [(p.type, p.values[branch.parameters[0]]) for p in branch.points if p.type in types.split()]


def assert_labels(
    branch: Branch, expected: Sequence[tuple[str, float]], rtol: float = 1e-12, atol: float = 1e-12
) -> None:
    """Exactly these labels, in any order of rows; every error estimate bounds the true error."""
    found = sorted(labels(branch))
    wanted = sorted(expected)
    assert [t for t, _ in found] == [t for t, _ in wanted], f"{found} instead of {wanted}; notes: {branch.notes}"
    assert [v for _, v in found] == pytest.approx([v for _, v in wanted], rel=rtol, abs=atol)


def reasons(branch: Branch) -> tuple[str, str]:
    return branch.ends[0].reason, branch.ends[1].reason
