"""Short ways to follow a small model, and to compare its labels with a closed form."""

from __future__ import annotations

from ast import literal_eval
from collections.abc import Mapping, Sequence
from functools import lru_cache

import pytest

import contin
from contin.continuation.branch import Branch


def model(equations: Mapping[str, str], states: Mapping[str, object], parameters: Mapping[str, object], **parts):
    return contin.Model("case", states=dict(states), parameters=dict(parameters), equations=dict(equations), **parts)


def _key(mapping: Mapping[str, object]) -> str:
    return repr(dict(mapping))


@lru_cache(maxsize=200)
def _model(equations: str, states: str, parameters: tuple[str, ...], parts: str):
    """One model, and so one compilation, for all starts and parameter values."""
    return model(literal_eval(equations), literal_eval(states), dict.fromkeys(parameters, 0.0), **literal_eval(parts))


def follow(
    equations: Mapping[str, str], states: Mapping[str, object], parameters: Mapping[str, object],
    range: tuple[float, float], parts: Mapping[str, object] | None = None, **options,
) -> Branch:  # fmt: skip
    """The branch of equilibria through `states` while the first parameter varies."""
    declared = {k: v if isinstance(v, dict) else 0.0 for k, v in states.items()}
    system = _model(_key(equations), _key(declared), tuple(parameters), _key(parts or {}))
    guess = {k: v["value"] if isinstance(v, dict) else v for k, v in states.items()}
    start = contin.equilibrium(system, guess, parameters)
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
