"""Connections with cycles do not depend on the states' names and units; a connection that quadrature gives.

u' = 1 - u^2, v' = u v + mu + kappa a, and (a, b) falls to the cycle (cos 2t, sin 2t) where u = 1, to rest where
u = -1: along the orbit from the equilibrium, u = tanh t, v is bounded where the integral of (mu + kappa a(t)) / cosh t
is zero.
"""

import json

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import contin
from contin.homoclinic.parts_of_vectors import vectors
from contin.homoclinic.units_of_ends import units_between
from contin.lowering.system import compile_system
from contin.model.yaml_loader import load_model_text
from contin.problems.orbits.mesh.layout import Profile, node_times
from contin.problems.orbits.rests_and_cycles import Cycle, Rest
from contin.store.encoded import Table
from contin.symbolic.passes.connecting import CycleEnd, SaddleEnd, connecting
from tests.cli.calls import call, results, run_file

KAPPA = 0.3


def equations(units, names=("u", "v", "a", "b")):
    """With x = unit * (x of the first lines)."""
    u, v, a, b = (f"({name}/{float(unit)!r})" for name, unit in zip(names, units, strict=True))
    rates = (
        f"1 - {u}^2", f"{u}*{v} + mu + kappa*{a}",
        f"{a}*({u} - {a}^2 - {b}^2) - 2*{b} + 1 - {u}^2", f"{b}*({u} - {a}^2 - {b}^2) + 2*{a}",
    )  # fmt: skip
    return {name: f"{float(unit)!r}*({rate})" for name, unit, rate in zip(names, units, rates, strict=True)}


def model(units, mu, names=("u", "v", "a", "b")):
    parameters = {"mu": mu, "kappa": KAPPA}
    return {
        "contin": 1, "name": "tanh", "states": dict.fromkeys(names, 0), "parameters": parameters,
        "equations": equations(units, names),
    }  # fmt: skip


def cycle_states(t, mu):
    """v = -mu + p cos 2t + q sin 2t: v' = v + mu + kappa cos 2t."""
    p, q = -KAPPA / 5, 2 * KAPPA / 5
    v = -mu + p * np.cos(2 * t) + q * np.sin(2 * t)
    return np.column_stack([np.ones_like(t), v, np.cos(2 * t), np.sin(2 * t)])


def connected_at():
    """mu, by quadrature."""

    def rate(t, y):
        u, (a, b, _) = np.tanh(t), y
        fall = u - a * a - b * b
        return [a * fall - 2 * b + 1 - u * u, b * fall + 2 * a, a / np.cosh(t)]

    path = solve_ivp(rate, (-20, 34), [0.0, 0.0, 0.0], method="DOP853", rtol=1e-13, atol=1e-16)
    return -KAPPA * path.y[2, -1] / np.pi


def ends(units, mu=0.0):
    system = compile_system(load_model_text(json.dumps(model(units, mu))))
    p = np.array([{"mu": mu, "kappa": KAPPA}[name] for name in system.parameter_names])
    h = np.full(20, 1 / 20)
    u = cycle_states(np.pi * node_times(h, 4), mu) * units
    rest = Rest(system, p, np.array([-1.0, mu, 0.0, 0.0]) * units)
    return rest, Cycle(system, p, Profile(4, u, np.pi, h, mu))


def test_lengths_are_measured_in_every_states_own_unit():
    units = np.array([2.0**-20, 2.0**20, 2.0**-10, 2.0**7])
    plain, scaled = (units_between(*ends(one)) for one in (np.ones(4), units))
    np.testing.assert_array_equal(scaled, plain * units)
    rest, cycle = ends(units)
    first, there = ends(np.ones(4))
    plainly = first.basis(True, plain) * units[:, None]
    np.testing.assert_allclose(np.abs(rest.basis(True, scaled)), np.abs(plainly), rtol=1e-9, atol=1e-30)
    strong = cycle.strongest(True)
    moment = np.zeros(1)
    w, plainly = cycle.adjoint(strong, moment, scaled), there.adjoint(strong, moment, plain)
    np.testing.assert_allclose(np.abs(w * scaled), np.abs(plainly * plain), rtol=1e-6, atol=1e-9)
    aside = cycle.states[0] + 1e-3 * scaled
    assert cycle.nearest(aside, 0.01, scaled) == pytest.approx(there.nearest(aside / units, 0.01, plain), abs=1e-9)


@pytest.mark.parametrize("place", ["start", "end"])
def test_states_may_have_the_names_of_what_is_solved_for(place):
    """A state `v` was an error inside contin, and `v10` was taken for a part of an eigenvector."""
    names = ("v", "v10", "sigma0", "distance")
    flow = load_model_text(json.dumps(model(np.ones(4), 0.0, names)))
    ends = CycleEnd((1,)), SaddleEnd(2)
    made = connecting(flow, *(ends if place == "start" else ends[::-1]), [1.0] * 4).model
    own = [*made.state_names, *made.parameter_names]
    assert len(set(own)) == len(own)
    groups = [[own[k] for k, _ in pairs] for _, pairs in vectors(own)]
    modes = [[f"{name}:w0:{1 if place == 'start' else 2}" for name in names]]
    assert all(group in groups for group in modes)
    assert not any(":cycle" in name for group in groups for name in group)


def test_a_file_keeps_the_equations_of_orbits_between_an_equilibrium_and_a_cycle():
    """Conditions on the equilibrium alone hold no value at an end, which a model file asks for: `damaged` before."""
    flow = load_model_text(json.dumps(model(np.ones(4), 0.0)))
    made = connecting(flow, SaddleEnd(1), CycleEnd((1,)), [1.0] * 4).model
    table = Table()
    table.model(made)
    again = Table.of(json.loads(json.dumps(table.document()))).models[0]
    assert [c.residual for c in again.conditions] == [c.residual for c in made.conditions]


@pytest.mark.long
@pytest.mark.parametrize("units", [(1.0, 1.0, 1.0, 1.0), (1e-6, 1e6, 1e-6, 1e-6), (1e6, 1e-6, 1e6, 1e6)])
def test_an_orbit_to_a_cycle_is_where_quadrature_says_in_any_units(units, tmp_path):
    """It was off by 6e-5, beside a stated error of 2e-7, in the second of these units, and not found in the first."""
    exact = connected_at()
    mu, t = exact + 0.02, np.linspace(0, np.pi, 101)
    rows = np.column_stack([t, cycle_states(t, mu) * units])
    np.savetxt(tmp_path / "cycle.csv", rows, delimiter=",", header="t,u,v,a,b", comments="", fmt="%.17g")
    around = [mu - 0.02, mu + 0.02]
    runs = [
        {"name": "cycle", "samples": "cycle.csv", "parameter": "mu", "range": around, "values": {"mu": [mu]}},
        {
            "name": "heart", "as": "connection", "start": {"u": -units[0], "v": mu * units[1], "a": 0, "b": 0},
            "to": "cycle.UZ1", "parameter": ["mu", "kappa"], "range": {"mu": [-1, 1], "kappa": [0.28, 0.32]},
            "values": {"kappa": [KAPPA]},
        },
    ]  # fmt: skip
    out = {"json": "out.json", "save": "out.contin"}
    assert call("run", run_file(tmp_path, model(units, mu), *runs, outputs=out), "--quiet") == 0
    point = results(tmp_path / "out.json")["branches"][1]["points"][0]
    assert abs(point["values"]["mu"] - exact) < point["error"] < 1e-8
    kept = contin.read(tmp_path / "out.contin")["heart"]["UZ1"].problem.computed()
    assert kept.values["mu"] == point["values"]["mu"]
