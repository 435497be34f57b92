"""Points of codimension two of cycles whose return map is the flow of a known equation, in bent coordinates.

States u = M h(X) with X as in `test_coefficients`, h a chain of shears X_i -> X_i + k X_j X_m and M a matrix of
condition 5: no plane is invariant as it stands, and no eigenfunction is simple. Places stay, and so do numbers that
depend on no eigenvector's length.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import pi

import numpy as np
import pytest

import contin
from contin.model.model import Model
from tests.loci.equilibria.planes import amplitude
from tests.loci.orbits.test_codim_two import CIRCLE, SQUARE, twisted
from tests.loci.orbits.test_coefficients import CUBIC, assert_within, resonant

SHEARS = ((0, 0.4, 3, 2), (3, -0.5, 0, 2), (2, 0.6, 1, 3), (1, 0.3, 2, 2))  # i, k, j, m
SAMPLES = 401


def bend(n: int) -> np.ndarray:
    """A matrix of condition 5."""
    rng = np.random.default_rng(7)
    one, two = (np.linalg.qr(rng.normal(size=(n, n)))[0] for _ in range(2))
    return one @ np.diag(np.logspace(0.0, np.log10(5.0), n)) @ two


def weighted(weights: np.ndarray, terms: list[str]) -> str:
    return " + ".join(f"({w!r})*({t})" for w, t in zip(weights.tolist(), terms, strict=True))


def bent(equations: Mapping[str, str], matrix: np.ndarray) -> tuple[dict[str, str], dict[str, str]]:
    """The equations of u, and definitions of X and X'."""
    names, us = list(equations), [f"u{k}" for k in range(len(equations))]
    sheared = {f"h{k}": weighted(row, us) for k, row in enumerate(np.linalg.inv(matrix))}
    now, stages = list(sheared), []
    for count, (i, k, j, m) in reversed([*enumerate(SHEARS)]):
        stages.append(list(now))
        sheared[f"w{count}"] = f"{now[i]} - ({k})*{now[j]}*{now[m]}"
        now[i] = f"w{count}"
    definitions = sheared | dict(zip(names, now, strict=True))
    rates = [f"v{k}" for k in range(len(names))]
    definitions |= dict(zip(rates, equations.values(), strict=True))
    for count, ((i, k, j, m), x) in enumerate(zip(SHEARS, reversed(stages), strict=True)):
        definitions[f"r{count}"] = f"{rates[i]} + ({k})*({rates[j]}*{x[m]} + {x[j]}*{rates[m]})"
        rates[i] = f"r{count}"
    return {u: weighted(row, rates) for u, row in zip(us, matrix, strict=True)}, definitions


@dataclass(frozen=True)
class Case:
    """What is followed to a point, where it is and what it has."""

    equations: Mapping[str, str]
    label: str
    values: Mapping[str, object] = field(default_factory=dict)
    ratio: tuple[str, str, float] | None = None
    case: str | None = None
    p: tuple[float, float] = (-0.2, 0.2)
    q: tuple[float, float] = (-0.2, 0.2)
    at: float = 0.0  # q


FOLD = {"p": (-0.5, 0.5), "q": (-0.3, 0.4)}
SPIRAL = amplitude("c", "d", "q + 0.2*x + 0.4*x^2 - (c^2 + d^2)", "0.3")
PAIRED = amplitude("e", "f", f"p + 0.5*{SQUARE} - 0.7*(e^2 + f^2)", "0.15")
FLIPS = twisted(f"p/2 + q + 0.3*{SQUARE} - 0.2*(e^2 + f^2)", "-1")
ROUND = 2 * pi
CASES = {
    "R1": Case(
        {"x": "y", "y": "p - x^2 + q*y + x*y"}, "LPC", ratio=("b", "a", 2 - 1 / ROUND), **FOLD
    ),  # a = -(2 pi)^2, b - 2 a = 2 pi
    "R2": Case(
        twisted("0", f"q - 0.8*{SQUARE}", along_by_z="1", across_by_s=f"p - 0.5*{SQUARE}"), "PD",
        ratio=("D1", "C1", 0.8 / (0.5 * 4 * pi)), case="C1 < 0, D1 < 0", p=(-0.15, 0.15), q=(-0.15, 0.12),
    ),
    "R3": Case(
        resonant(0.5, 2), "NS", {"a": -CUBIC[0] / (6 * pi * 0.25)}, case="invariant circle stable", q=(0.3, 0.36),
        at=1 / 3,
    ),
    "R4": Case(
        resonant(0.6, 3), "NS", {"A0": [-CUBIC[0] / 0.6, -CUBIC[1] / 0.6]}, case="|A0| < 1", q=(0.22, 0.28), at=1 / 4
    ),
    "LPPD": Case(
        {"x": f"p - x^2 + 0.8*{SQUARE}", **twisted(f"q + 0.25*x + 0.4*x^2 - 0.7*{SQUARE}", "-1")}, "LPC",
        {"a": 4.0, "c": 16.0}, **FOLD,
    ),
    "LPNS": Case(
        {"x": "p - x^2 + 0.8*(c^2 + d^2)", "c": SPIRAL[0], "d": SPIRAL[1]}, "LPC",
        {"theta": -0.2, "E": (0.4 - 1.2 / 0.8) / ROUND, "c": 1.0}, case="s = -1, theta < 0, no torus", **FOLD,
    ),
    "PDNS": Case(
        {**FLIPS, "e": PAIRED[0], "f": PAIRED[1]}, "NS", {"theta": 0.4 / 1.4, "delta": 0.5 / 0.3},
        case="difficult case III", p=(-0.15, 0.2), q=(-0.17, 0.15),
    ),
}  # fmt: skip
LONGER = ("LPNS", "PDNS")


@pytest.mark.parametrize("type_", [pytest.param(t, marks=pytest.mark.long if t in LONGER else ()) for t in CASES])
def test_places_and_invariant_numbers_stay(type_):
    case = CASES[type_]
    whole = {**CIRCLE, **case.equations}
    matrix, angle = bend(len(whole)), np.linspace(0.0, ROUND, SAMPLES)
    folds = case.label == "LPC"
    x = np.zeros((SAMPLES, len(whole)))
    x[:, 0], x[:, 1], x[:, 2] = np.cos(angle), np.sin(angle), 0.5 if folds else 0.0  # x^2 = p = 1/4
    for i, k, j, m in SHEARS:
        x[:, i] += k * x[:, j] * x[:, m]
    u, (equations, definitions) = x @ matrix.T, bent(whole, matrix)
    model = Model(
        "bent", states=dict(zip(equations, u[0].tolist(), strict=True)), equations=equations, definitions=definitions,
        parameters={"p": 0.25 if folds else case.p[0], "q": case.q[0]},
    )  # fmt: skip
    family = contin.continuation(
        contin.periodic_orbit(model, u, period=ROUND), "p", case.p, direction="down" if folds else "up",
        settings={"stop_at": (case.label,)},
    )  # fmt: skip
    seed = next(p for p in family.points if p.type == case.label).locus(("p", "q"))
    curve = contin.continuation(seed, ("p", "q"), {"p": case.p, "q": case.q})
    (point,) = curve.points
    assert (point.type, curve.notes) == (type_, ())
    assert abs(point.values["p"]) <= point.error < 1e-8
    assert abs(point.values["q"] - case.at) <= point.error
    form = point.normal_form
    for key, value in case.values.items():
        assert_within(form, key, value)
    if case.ratio is not None:
        one, other, value = case.ratio
        off = sum(form["errors"][key] / abs(form[key]) for key in (one, other)) * abs(value)
        assert abs(form[one] / form[other] - value) <= off < 1e-6
    if case.case is not None:
        assert form["case"] == case.case
