"""Connecting orbits found from afar: by homotopy, from samples, from long periodic orbits; and those that persist."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad

import contin
from contin.errors import InputError, NoSolutionError
from contin.homoclinic.projections import turned
from contin.homoclinic.subspaces import left_subspace
from contin.model.model import Model

ORIGIN = {"x": 0, "y": 0, "z": 0}
LORENZ = Model(
    "lorenz", states={"x": 0, "y": 0, "z": 0}, parameters={"r": 10.0, "s": 10.0, "b": 8 / 3},
    equations={"x": "s*(y - x)", "y": "r*x - y - x*z", "z": "x*y - b*z"},
)  # fmt: skip
DUFFING = Model(
    "duffing", states={"x": 0, "y": 0}, parameters={"m": 0.0, "k": 1.0, "d": 0.0},
    equations={"x": "y", "y": "x - k*x^3 + (m + d)*y"},
)  # fmt: skip


@pytest.mark.parametrize("r", [10.0, 20.0])
def test_the_homoclinic_orbit_of_the_lorenz_equations_is_found_from_either_side(r):
    """At r = 13.926557407520 for s = 10, b = 8/3 (Sparrow 1982; digits of Shimizu and others)."""
    start = contin.connection(LORENZ, ORIGIN, parameters={"r": r})
    loops = contin.continuation(start, ("r", "s"), {"r": (2, 60), "s": (9, 11)}, settings={"steps": 1})
    here = int(np.argmin(np.abs(loops.columns["s"] - 10.0)))
    assert loops.columns["s"][here] == 10.0
    assert loops.columns["r"][here] == pytest.approx(13.926557407520, abs=1e-8)


def test_the_shilnikov_orbit_of_an_electronic_circuit():
    """Freire, Rodriguez-Luis, Gamero and Ponce (1993); AUTO-07p's demo `cir` starts at nu = -0.721309, beta = 0.6."""
    circuit = Model(
        "cir", states={"x": 0, "y": 0, "z": 0}, parameters={"nu": -0.715, "beta": 0.6},
        definitions={"k": "0.933578*(y - x)^3"},
        equations={"x": "(-(beta + nu)*x + beta*y - 0.328578*x^3 + k)/0.6", "y": "beta*x - beta*y - z - k", "z": "y"},
    )  # fmt: skip
    (seed,) = contin.connection(circuit, ORIGIN).locus(("nu", "beta"))
    assert seed.z[-2:] == pytest.approx([0.6, -0.721309], abs=1e-6)


def test_the_angle_of_a_driven_pendulum_goes_round_once():
    """a'' + b a' + sin a = I: rotations begin at I = 4 b/pi + O(b^3) (Melnikov)."""
    pendulum = Model(
        "pendulum", states={"a": {"value": 3.0, "period": "2*pi"}, "v": 0}, parameters={"I": 0.2, "b": 0.1},
        equations={"a": "v", "v": "-b*v - sin(a) + I"},
    )  # fmt: skip
    start = contin.connection(pendulum, {"a": 3.0})
    loops = contin.continuation(start, ("I", "b"), {"I": (0, 1), "b": (0.01, 0.1)})
    slope = loops.columns["I"] / loops.columns["b"]
    assert np.all(np.abs(slope - 4 / np.pi) < 0.5 * loops.columns["b"] ** 2)
    assert np.ptp(loops.columns["a.max"] - loops.columns["a.min"]) < 1e-3


def test_a_loop_comes_from_few_samples():
    t = np.linspace(-6, 6, 25)
    x = np.sqrt(2) / np.cosh(t)
    start = contin.connection(DUFFING, {"x": 0}, samples=(t, np.stack([x, -x * np.tanh(t)], axis=1)))
    loops = contin.continuation(start, ("m", "k"), {"m": (-1, 1), "k": (0.5, 2)})
    np.testing.assert_allclose(loops.columns["m"], 0, atol=1e-10)
    np.testing.assert_allclose(loops.columns["x.max"], np.sqrt(2 / loops.columns["k"]), atol=1e-8)


def test_a_loop_comes_from_a_long_periodic_orbit_and_its_saddle():
    leaf = Model(
        "leaf", states={"x": 0.6, "y": 0}, parameters={"m": 0.4, "a": -0.25, "b": 1},
        equations={"x": "a*x + b*y - a*x^2 + m*x*(2 - 3*x)", "y": "b*x + a*y - 1.5*b*x^2 - 1.5*a*x*y - 2*m*y"},
    )  # fmt: skip
    line = contin.continuation(contin.equilibrium(leaf), "m", (-1, 1))
    family = contin.continuation(line["HB1"].switch(), "m", (-1, 1), values={"period": [12]})
    start = contin.connection(family["UZ1"], {"x": 0, "y": 0})
    loops = contin.continuation(start, ("m", "a"), {"m": (-0.5, 0.5), "a": (-0.35, -0.15)})
    np.testing.assert_allclose(loops.columns["m"], 0, atol=1e-9)
    np.testing.assert_allclose(loops.columns["x.max"], 1, atol=1e-7)
    with pytest.raises(InputError, match="name the saddle"):
        contin.connection(family["UZ1"])


@pytest.fixture(scope="module")
def skew():
    """x = tanh t drives y, which decays backwards in time, and z: connections of two planes at every k."""
    return Model(
        "skew", states={"x": 0, "y": 0, "z": 0}, parameters={"k": 0.5, "k2": 0.0},
        equations={"x": "1 - x^2", "y": "y*(1 + 0.3*x) + k*(1 - x^2)", "z": "-z + k*(1 - x^2)"},
    )  # fmt: skip


def test_connections_of_two_planes_in_space_persist(skew):
    """y = -k Int_t^inf sech(s)^2 exp(-(s - t) - 0.3 log(cosh s/cosh t)) ds."""
    branch = contin.continuation(contin.connection(skew, {"x": -1}, {"x": 1}), "k", (0.1, 1))
    assert (branch.kind, branch.locus, branch.parameters) == ("connection", None, ("k",))

    def y(t):
        return quad(
            lambda s: np.cosh(s) ** -2 * np.exp(t - s) * (np.cosh(t) / np.cosh(s)) ** 0.3, t, t + 40, epsabs=1e-12
        )[0]

    lowest = max(y(t) for t in np.linspace(-1.5, 0.0, 301))
    np.testing.assert_allclose(branch.columns["y.min"] / branch.columns["k"], -lowest, rtol=1e-5)


def test_dimensions_that_do_not_fit_are_named(skew):
    with pytest.raises(InputError, match="name two parameters"):
        contin.continuation(contin.connection(DUFFING, {"x": 0}), "m", (-1, 1))
    with pytest.raises(InputError, match="name one parameter"):
        contin.connection(skew, {"x": -1}, {"x": 1}).locus(("k", "k2"))


@pytest.mark.seldom
def test_a_failure_names_the_step_of_the_homotopy():
    """Antidamping that no parameter undoes: the trajectory's end cannot be brought back."""
    start = contin.connection(DUFFING, {"x": 0}, parameters={"d": 0.3})
    with pytest.raises(NoSolutionError, match=r"step 1 of the homotopy .* at k = "):
        contin.continuation(start, ("k", "d"), {"k": (0.5, 2), "d": (0.25, 0.35)})


def test_samples_far_from_the_saddle_are_refused():
    t = np.linspace(0, 1, 10)
    samples = t, np.stack([1 + 0 * t, t], axis=1)
    with pytest.raises(NoSolutionError, match="begins at"):
        contin.connection(DUFFING, {"x": 0}, samples=samples).locus(("m", "k"))


def test_the_derivative_of_an_invariant_subspace_is_the_limit_of_differences():
    generator = np.random.default_rng(5)
    for n, count in ((2, 1), (4, 2), (5, 3)):
        matrix = np.diag(np.linspace(-2.0, 2.0, n)) + 0.1 * generator.normal(size=(n, n))
        change = generator.normal(size=(n, n))
        reference = left_subspace(matrix, count, True)
        exact = turned(matrix.T, left_subspace(matrix, count, True, reference), reference, change.T[None])[0]
        step = 1e-5
        pair = [left_subspace(matrix + sign * step * change, count, True, reference) for sign in (1.0, -1.0)]
        np.testing.assert_allclose(exact, (pair[0] - pair[1]) / (2 * step), atol=1e-8)


@pytest.mark.seldom
def test_an_orbit_that_turns_about_a_saddle_focus_on_its_way_out_is_one_loop():
    """AUTO's demo tfc, a food chain, with rates 0.048 +- 0.074 i and -0.61 at the saddle: the limit that the family's
    last orbits tell and the connecting orbit agree to the limit's error."""
    model = Model(
        "chain", states={"x": -0.2, "y": -2.08, "z": 10.9}, parameters={"d1": 0.5, "d2": 0.01},
        definitions={"X": "exp(x)", "Y": "exp(y)", "f1": "5/(1 + 3*X)", "f2": "0.1/(1 + 2*Y)"},
        equations={"x": "1 - X - f1*Y", "y": "f1*X - d1 - f2*z", "z": "z*(f2*Y - d2)"},
    )  # fmt: skip
    line = contin.continuation(contin.equilibrium(model), "d1", (0.1, 1.2))
    family = contin.continuation(line["HB1"].switch(), "d1", (0.1, 1.2))
    limit = next(p for p in family.points if p.type == "HOM")
    (seed,) = limit.locus(("d1", "d2"))
    connection = float(seed.z[-1])
    assert abs(connection - 0.3165523032845) < 1e-9
    assert abs(connection - limit.values["d1"]) < limit.error < 3e-6
