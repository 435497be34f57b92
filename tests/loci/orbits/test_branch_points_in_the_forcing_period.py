"""Branch points of forced orbits whose period depends on the parameters: T - T(p) has a second derivative."""

import numpy as np
import pytest
from scipy.special import i0

import contin
from contin.model.model import Model
from contin.problems.orbits.linearised.linear import OrbitLinear

PARAMETERS = {"w": 1.0, "q": 0.5, "d": 0.2}
BOX = {"w": (0.6, 2.5), "q": (0.1, 12.0), "d": (0.05, 0.4)}


@pytest.fixture(scope="module")
def family():
    """x'' + d x' + x^3 = q cos(w t): with times of 1/w and states of w it depends on d/w and q/w^3 only."""
    model = Model(
        "ueda", states={"x": 0.1, "y": 0.0}, parameters=PARAMETERS, forcing={"period": "2*pi/w"},
        equations={"x": "y", "y": "-d*y - x^3 + q*cos(w*t)"},
    )  # fmt: skip
    return contin.continuation(contin.periodic_orbit(model), "q", (0.05, 5.0))


def curve(family, *names, values=None):
    return contin.continuation(family["BPC1"].locus(), names, {n: BOX[n] for n in names}, values=values)


def test_curves_in_the_frequency_are_those_in_the_damping(family):
    frequencies = [0.8, 1.25, 1.6]
    over_frequency = curve(family, "w", "q", values={"w": frequencies})
    over_damping = curve(family, "d", "q", values={"d": [0.2 / w for w in frequencies]})
    assert len(over_frequency) < 100  # short steps (933 rows) where Newton's method converges linearly
    for w in frequencies:
        (one,) = [p for p in over_frequency.points if p.type == "UZ" and p.values["w"] == pytest.approx(w)]
        (other,) = [p for p in over_damping.points if p.type == "UZ" and p.values["d"] == pytest.approx(0.2 / w)]
        assert one.values["q"] / w**3 == pytest.approx(other.values["q"], rel=1e-9)


def test_orbits_that_cross_transcritically_in_the_frequency_do_so_at_the_rate_of_the_averages():
    """z' = z (w - 1 + b cos(w t)) - z^2, y = z + m(t): z = (w - 1) exp(b sin t)/I0(b) + ..., its square I0(2 b)."""
    b, m = 0.7, "w^2*cos(w*t) + sin(2*w*t)/3"
    model = Model(
        "crossing", states={"x": 0.1, "y": 0.0}, parameters={"w": 0.8}, forcing={"period": "2*pi/w"}, equations={
            "x": "-x + cos(w*t)",
            "y": f"(y - ({m}))*(w - 1 + {b}*cos(w*t)) - (y - ({m}))^2 - w^3*sin(w*t) + 2*w*cos(2*w*t)/3",
        },
    )  # fmt: skip
    orbits = contin.continuation(contin.periodic_orbit(model, {"x": 0.3, "y": 0.64}), "w", (0.5, 1.5))
    (point,) = orbits.points  # a fold at 1 - 1e-6 before
    assert point.type == "BPC"
    assert abs(point.values["w"] - 1.0) <= point.error < 1e-10
    assert point.normal_form["kind"] == "transcritical"
    assert point.normal_form["slope"] == pytest.approx(i0(b) / np.sqrt(i0(2.0 * b)), abs=1e-9)


def test_second_derivatives_of_the_equations_are_differences_of_the_first(family):
    model = family.problem.system.model
    orbits = contin.continuation(contin.periodic_orbit(model, parameters={"q": 1.0}), "w", (0.9, 1.1))
    z = orbits.z[-1][~np.isnan(orbits.z[-1])]
    scale = np.full(z.size, 0.7)
    generator, step = np.random.default_rng(1), 1e-5
    linear = OrbitLinear(orbits.problem, z, scale, z)
    v = generator.normal(size=linear.nu + 2)

    def slopes(side):
        moved = z.copy()
        moved[linear.unknowns] += side * step * linear.units * v
        return OrbitLinear(orbits.problem, moved, scale, z).jacobian.toarray()

    differences = (slopes(1.0) - slopes(-1.0)) / (2.0 * step)
    found = linear.hessian(v).toarray()
    assert abs(found[-1, -1]) > 1.0
    np.testing.assert_allclose(found, differences, atol=1e-6 * np.abs(differences).max())
