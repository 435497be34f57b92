"""Diagrams of forced flows: responses and their bifurcations planted in closed form, in random coordinates."""

from __future__ import annotations

import numpy as np
import pytest

from contin import api
from contin.errors import InputError
from contin.model.model import Model

RANGE = (-0.5, 0.7)

# In y the response is 0 and loses its stability at p = 0; the second state of PD turns by half a turn a period.
PLANTED = {
    "LPC": ["p - y1^2"],
    "BPC": ["p*y1 - y1^3"],
    "PD": [
        "(p - 1)/2*y1 + (p + 1)/2*(cos(w*t)*y1 + sin(w*t)*y2) - w/2*y2 - (y1^2 + y2^2)*y1",
        "(p - 1)/2*y2 + (p + 1)/2*(sin(w*t)*y1 - cos(w*t)*y2) + w/2*y1 - (y1^2 + y2^2)*y2",
    ],
    "NS": ["p*y1 - 0.3*y2 - (y1^2 + y2^2)*y1", "p*y2 + 0.3*y1 - (y1^2 + y2^2)*y2"],
}


def planted(type_: str, extra: int, seed: int) -> Model:
    """x = M (y + c(t)): c moves round once a period, M is a random matrix, `extra` states are stable and coupled."""
    rng = np.random.default_rng(seed)
    core = PLANTED[type_]
    n = len(core) + extra
    w = float(rng.uniform(0.6, 1.5))
    matrix = np.linalg.qr(rng.normal(size=(n, n)))[0] @ np.diag(rng.uniform(0.5, 2.0, n))
    inverse = np.linalg.inv(matrix)
    names = [f"x{k}" for k in range(n)]
    size, turn = rng.uniform(0.3, 1.5, n), rng.uniform(0.0, 6.0, n)
    rates = rng.uniform(0.5, 2.0, extra)
    fast = [f"{-float(r)!r}*y{k + 1} + 0.3*y1^2" for k, r in zip(range(len(core), n), rates, strict=True)]
    centre = [f"{a!r}*cos(w*t + {b!r})" for a, b in zip(size.tolist(), turn.tolist(), strict=True)]
    drift = [f"(-{a!r}*w*sin(w*t + {b!r}))" for a, b in zip(size.tolist(), turn.tolist(), strict=True)]
    own = {f"y{k + 1}": " + ".join(f"({float(inverse[k, j])!r})*{names[j]}" for j in range(n)) + f" - {centre[k]}"
           for k in range(n)}  # fmt: skip
    rate = {f"g{k + 1}": f"{f} + {d}" for k, (f, d) in enumerate(zip([*core, *fast], drift, strict=True))}
    equations = {names[j]: " + ".join(f"({float(matrix[j, k])!r})*g{k + 1}" for k in range(n)) for j in range(n)}
    at_rest = matrix @ (size * np.cos(turn) + (0.5 if type_ == "LPC" else 0.02))
    states = dict(zip(names, at_rest.tolist(), strict=True))
    return Model(
        "planted", states=states, parameters={"p": 0.3 if type_ == "LPC" else -0.3, "w": w},
        definitions=own | rate, equations=equations, forcing={"period": "2*pi/w"},
    )  # fmt: skip


def check(type_: str, extra: int, seed: int) -> None:
    diagram = api.diagram(planted(type_, extra, seed), "p", RANGE)
    own = diagram["start"]
    points = [p for p in own.points if p.type != "UZ"]
    assert [p.type for p in points] == [type_], (type_, extra, seed, points)
    value = points[0].values["p"]
    assert abs(value) <= max(points[0].error, 1e-7), (type_, extra, seed, value, points[0].error)
    born = {"LPC": 0, "BPC": 1, "PD": 1, "NS": 0}[type_]
    assert len([b for b in diagram.branches if b.image_of is None]) == 1 + born
    assert all(b.kind == "orbit" for b in diagram.branches)
    if type_ in ("PD", "NS"):
        assert points[0].normal_form["criticality"] == "supercritical"


@pytest.mark.parametrize("type_", PLANTED)
@pytest.mark.parametrize("extra", [0, 2])
def test_planted_responses(type_, extra):
    check(type_, extra, 11)


@pytest.mark.long
@pytest.mark.parametrize("type_", PLANTED)
def test_planted_responses_in_many_coordinates(type_):
    for seed in range(12):
        for extra in range(5):
            check(type_, extra, 100 + seed)


def linear(d: float, strength: str = "1") -> Model:
    return Model(
        "linear", states={"x": 0.1, "y": 0}, parameters={"w": 0.5, "d": d},
        equations={"x": "y", "y": f"-5*x - d*y + {strength}*cos(w*t)"}, forcing={"period": "2*pi/w"},
    )  # fmt: skip


@pytest.mark.parametrize("d", [0.2, 0.0, -0.05])
def test_response_of_a_linear_oscillator(d):
    """Without damping no trajectory settles, and with a negative one all escape: Newton finds the response."""
    branch = api.diagram(linear(d), "w", (0.3, 1.5))["start"]
    w = branch.columns["w"]
    orbits = [branch.problem.profile(z).at(np.linspace(0.0, 1.0, 2001))[:, 0] for z in branch.z]
    np.testing.assert_allclose([x.max() for x in orbits], 1.0 / np.hypot(5.0 - w**2, d * w), rtol=5e-6)
    np.testing.assert_allclose(branch.columns["period"], 2.0 * np.pi / w, rtol=1e-12)
    assert d == 0.0 or not branch.points


def test_a_start_on_doubled_responses_leads_to_those_of_one_period():
    model = planted("PD", 0, 5)
    diagram = api.diagram(model, "p", RANGE, start={"x0": 1.0, "x1": 0.7}, parameters={"p": 0.4})
    assert diagram["start"].columns["period"][-1] == pytest.approx(2.0 * diagram["start/half"].columns["period"][0])
    assert [p.type for p in diagram["start/half"].points] == ["PD"]
    assert len(diagram.branches) == 2  # the doubled responses are not followed again


@pytest.mark.seldom
def test_all_responses_that_attract_and_each_once():
    """x = c(t) + y, y' = y (1 - y) (1 + y): two attract, at every p."""
    model = Model(
        "two", states={"x": 3.0}, parameters={"p": 0.0, "w": 1.0}, forcing={"period": "2*pi/w"},
        definitions={"y": "x - cos(w*t)"}, equations={"x": "(1 + p)*y*(1 - y)*(1 + y) - w*sin(w*t)"},
    )  # fmt: skip
    diagram = api.diagram(model, "p", RANGE, start=["all", {"x": 2.5}])
    highest = sorted(float(b.columns["x.max"][0]) for b in diagram.branches)
    np.testing.assert_allclose(highest, [0.0, 2.0], atol=1e-6)


def test_a_forced_flow_has_no_equilibria_and_no_phase_diagram():
    with pytest.raises(InputError, match="periodic responses"):
        api.equilibrium(linear(0.1))
    with pytest.raises(InputError, match="two states more"):
        api.phase(linear(0.1), ("w", "d"), {"w": (0.3, 1), "d": (0, 1)})
