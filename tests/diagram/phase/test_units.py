"""Phase diagrams of modules whose states differ by many orders of magnitude: the regions are those of any units."""

import numpy as np
import pytest

import contin

SMALL, LARGE = 1e-9, 1e3


def switches(u, v):
    """Two bistable modules, x of order u and y of order v, that push each other."""
    return contin.Model(
        "switches", states={"x": -u, "y": -v}, parameters={"p": -0.6, "q": -0.5},
        equations={
            "x": f"{u!r}*p + x - x^3/{u!r}^2 + 0.1*y*{u!r}/{v!r}",
            "y": f"{v!r}*q + y - y^3/{v!r}^2 + 0.1*x*{v!r}/{u!r}",
        },
    )  # fmt: skip


def census(p, q):
    """(stable, all) equilibria of the modules in units of 1: y = 10 (x^3 - x - p), the roots of a polynomial in x."""
    x = np.poly1d([1.0, 0.0])
    y = (x**3 - x - p) * 10.0
    roots = (y - y**3 + 0.1 * x + q).roots
    roots = roots[np.abs(roots.imag) < 1e-9].real
    stable = 0
    for a in roots:
        matrix = np.array([[1.0 - 3.0 * a * a, 0.1], [0.1, 1.0 - 3.0 * y(a) ** 2]])
        stable += bool(np.all(np.linalg.eigvalsh(matrix) < 0.0))
    return stable, len(roots)


@pytest.mark.parametrize(("u", "v"), [pytest.param(SMALL, LARGE, marks=pytest.mark.long), (LARGE, SMALL)])
@pytest.mark.seldom
def test_two_switches_have_their_states_in_every_region(u, v):
    diagram = contin.phase(switches(u, v), ("p", "q"), {"p": (-0.6, 0.6), "q": (-0.5, 0.6)})
    assert sum(r.area for r in diagram.regions) == pytest.approx(1.0, abs=1e-6)
    assert diagram.check.disagreed == ()
    generator = np.random.default_rng(1)
    for p, q in generator.uniform((-0.6, -0.5), (0.6, 0.6), (40, 2)):
        region = diagram.region_at({"p": p, "q": q})
        assert (region.stable, region.total, region.orbits, region.aperiodic) == (*census(p, q), 0, 0)


@pytest.mark.seldom
def test_orbits_that_differ_in_a_small_state_only_are_two():
    """A switch of order 1e-3 beside an oscillator of order 1e3: two stable orbits where the switch is bistable."""
    model = contin.Model(
        "modules", states={"x": -1e-3, "a": 0.0, "b": 0.0}, parameters={"p": -0.6, "q": -0.5},
        equations={
            "x": "1e-3*p + x - x^3*1e6",
            "a": "(q + 200*x)*a - b - a*(a^2 + b^2)*1e-6",
            "b": "(q + 200*x)*b + a - b*(a^2 + b^2)*1e-6",
        },
    )  # fmt: skip
    diagram = contin.phase(model, ("p", "q"), {"p": (-0.6, 0.6), "q": (-0.5, 0.6)})
    for p, q in ((0.0, 0.5), (0.0, 0.0), (0.0, -0.3), (0.5, 0.4), (-0.5, 0.1)):
        roots = np.roots([-1.0, 0.0, 1.0, p])
        states = roots[np.abs(roots.imag) < 1e-9].real
        stable = [x for x in states if 3.0 * x * x > 1.0]
        region = diagram.region_at({"p": p, "q": q})
        assert region.total == len(states)
        assert region.stable == sum(q + 0.2 * x < 0.0 for x in stable)
        assert region.stable_orbits == sum(q + 0.2 * x > 0.0 for x in stable)
