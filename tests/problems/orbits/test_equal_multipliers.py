"""Multipliers that a symmetry makes equal pass the unit circle together: one label, with how many there are.

The uniform oscillation A = R exp(i w t) of the complex Ginzburg-Landau equation on cells of a ring or of a torus,

    A_t = (1 + i e) k lap A + (r + i) A + (1 + i m) |A|^2 A - |A|^4 A,

has for every wave vector the multipliers exp(T l), l those of [[2 R^2 (1 - 2 R^2) - q, e q], [2 m R^2 - e q, -q]],
where q is that of -k lap: two wave vectors of a ring have the smallest one, four of a square torus. Their pairs pass
where R^2 (1 - 2 R^2) = q.
"""

import numpy as np
import pytest
import sympy

import contin
from contin.errors import InputError

E, M = 2.0, 0.1
COUPLING = 0.0253
FIRST, LAST = 0.085, 0.11  # R^2 along the family


def along(cells, times):
    """States (u, v of every cell) of the uniform oscillation with R^2 = FIRST."""
    angle = (1 + M * FIRST) * times
    return np.tile(np.sqrt(FIRST) * np.column_stack([np.cos(angle), np.sin(angle)]), cells)


def formulas(shape):
    equations = {}
    for name in np.ndindex(shape):
        own = "".join(map(str, name))
        near = []
        for axis in range(len(shape)):
            for step in (1, -1):
                other = list(name)
                other[axis] = (other[axis] + step) % shape[axis]
                near.append("".join(map(str, other)))
        lap = {w: f"k*({' + '.join(w + one for one in near)} - {len(near)}*{w}{own})" for w in "uv"}
        s = f"(u{own}^2 + v{own}^2)"
        gain, turn = f"(r + {s} - {s}^2)", f"(1 + {M}*{s})"
        equations[f"u{own}"] = f"{lap['u']} - {E}*{lap['v']} + {gain}*u{own} - {turn}*v{own}"
        equations[f"v{own}"] = f"{lap['v']} + {E}*{lap['u']} + {gain}*v{own} + {turn}*u{own}"
    states = dict.fromkeys(equations, 0.0)
    parameters = {"r": -0.3, "k": COUPLING}
    return contin.load({"name": "cgl", "states": states, "parameters": parameters, "equations": equations})


def family(model, cells, settings):
    times = np.linspace(0.0, 2 * np.pi / (1 + M * FIRST), 21)
    start = {"r": -FIRST + FIRST**2, "k": COUPLING}
    orbit = contin.periodic_orbit(model, along(cells, times), times=times, parameters=start)
    return contin.continuation(orbit, "r", (-LAST + LAST**2, -FIRST + FIRST**2), settings=settings)


def check(branch, count, q):
    x = (1 - np.sqrt(1 - 8 * q)) / 4
    assert [point.label for point in branch.points] == ["NS1"]
    point = branch["NS1"]
    assert abs(point.values["r"] - (-x + x * x)) <= point.error < 1e-6
    assert point.vectors["kernel"] == count
    rate = np.sqrt(E * q * (E * q - 2 * M * x) - q * q)
    assert point.vectors["theta"] == pytest.approx(2 * np.pi / (1 + M * x) * rate, rel=0.02)  # in the middle of a step
    assert branch.effort["evaluations"] < 100  # thousands, where every halving is verified
    assert any(f"{count} pairs of multipliers cross at once" in note for note in branch.notes)
    assert not any("without a label" in note for note in branch.notes)
    with pytest.raises(InputError, match=f"{count} pairs of multipliers are on the unit circle at once: its curve"):
        contin.continuation(point.locus(["r", "k"]), ["r", "k"], {"r": (-1, 0), "k": (0, 0.1)})


@pytest.mark.parametrize("method", ["collocation", "shooting"])
def test_two_pairs_on_a_ring_are_one_label_at_the_place_of_the_closed_form(method):
    branch = family(formulas((3,)), 3, {"method": method})
    check(branch, 2, 3 * COUPLING)


@pytest.mark.long  # every day: the ring
def test_four_pairs_on_a_torus_are_one_label_at_the_place_of_the_closed_form():
    check(family(formulas((3, 3)), 9, {"intervals": 10}), 4, 3 * COUPLING)


@pytest.mark.parametrize("label", ["NS", "BPC"])
@pytest.mark.seldom
def test_equal_multipliers_of_a_large_system_are_one_label_at_the_place_of_the_closed_form(label):
    """NS of the subcritical family; without |A|^4 A and with m = 1.2 two real ones pass 1 where 2 R^2 (e m - 1) =
    q (1 + e^2), r = R^2."""
    subcritical = label == "NS"
    m, k = (M, 0.0759 / (2 - 2 * np.cos(2 * np.pi / 5))) if subcritical else (1.2, 0.04)
    gain, turn = "(r + s - s^2)" if subcritical else "(r - s)", f"(1 + {m}*s)"
    ring = contin.load({
        "name": "cgl", "kind": "pde", "fields": {"u": 0, "v": 0}, "parameters": {"r": -0.05, "k": k},
        "domain": {"x": {"to": 5, "points": 5, "periodic": True, "method": "differences"}},
        "definitions": {"s": "u^2 + v^2"},
        "equations": {
            "u": f"k*(dxx(u) - {E}*dxx(v)) + {gain}*u - {turn}*v",
            "v": f"k*(dxx(v) + {E}*dxx(u)) + {gain}*v + {turn}*u",
        },
    })  # fmt: skip
    line = contin.continuation(ring, "r", (-0.05, 0.05), settings={"stop_at": ("HB",)})
    span = (-0.1, 0.02) if subcritical else (-0.02, 0.12)
    settings = {"intervals": 6, "max_step": 0.3, "step": 0.05, "stop_at": (label,)}
    waves = contin.continuation(line["HB1"].switch(), "r", span, settings=settings)
    point, x = waves[f"{label}1"], (1 - np.sqrt(1 - 8 * 0.0759)) / 4
    exact = -x + x * x if subcritical else k * (2 - 2 * np.cos(2 * np.pi / 5)) * (1 + E * E) / (2 * (E * m - 1))
    assert len(waves.points) == 1
    assert abs(point.values["r"] - exact) <= point.error < 2e-3
    assert point.vectors["kernel"] == 2
    assert waves.effort["evaluations"] < 150
    with pytest.raises(InputError, match="at once"):
        point.locus(["r", "k"])[0] if subcritical else point.switch()


@pytest.mark.parametrize("copies", [2, 3])
def test_equal_multipliers_minus_one_are_one_label(copies):
    """Copies of (a, b) in a frame that turns half round the orbit: a' = mu a, b' = -b there, so that -exp(2 pi mu)."""
    states, equations = {"x": 1.0, "y": 0.0}, {"x": "x - y - x*(x^2 + y^2)", "y": "y + x - y*(x^2 + y^2)"}
    for a, b in ((f"a{j}", f"b{j}") for j in range(copies)):
        states |= {a: 0.0, b: 0.0}
        equations[a] = f"(mu - 1)/2*{a} + (mu + 1)/2*(x*{a} + y*{b}) - {b}/2 - {a}*({a}^2 + {b}^2)"
        equations[b] = f"(mu - 1)/2*{b} + (mu + 1)/2*(y*{a} - x*{b}) + {a}/2 - {b}*({a}^2 + {b}^2)"
    model = contin.load({"name": "bands", "states": states, "parameters": {"mu": -0.3}, "equations": equations})
    times = np.linspace(0.0, 2 * np.pi, 21)
    samples = np.zeros((21, 2 + 2 * copies))
    samples[:, 0], samples[:, 1] = np.cos(times), np.sin(times)
    branch = contin.continuation(contin.periodic_orbit(model, samples, times=times), "mu", (-0.3, 0.3))
    assert [point.label for point in branch.points] == ["PD1"]
    point = branch["PD1"]
    assert abs(point.values["mu"]) <= point.error < 1e-6
    assert point.vectors["kernel"] == copies
    with pytest.raises(InputError, match=f"{copies} multipliers are critical at once"):
        point.switch()


DISPERSED, SHIFT = 2.0, 1.2  # Benjamin and Feir: in step is unstable from R^2 = q (1 + e^2) / (2 (e m - 1)) on


def three(z, r):
    """Three cells of the cubic equation, each beside the others, k = .08, as (u, v) of every cell."""
    rows, sums = [], (z[0] + z[2] + z[4], z[1] + z[3] + z[5])
    for u, v in zip(z[::2], z[1::2], strict=True):
        du, dv, s = sums[0] - 3 * u, sums[1] - 3 * v, u**2 + v**2
        rows += [0.08 * (du - DISPERSED * dv) + (r - s) * u - (1 + SHIFT * s) * v]
        rows += [0.08 * (dv + DISPERSED * du) + (r - s) * v + (1 + SHIFT * s) * u]
    return rows


@pytest.mark.parametrize("written", [True, False])
def test_two_real_multipliers_that_pass_one_are_one_label_at_the_place_of_the_closed_form(written):
    """Of a function and of formulas without declared symmetries: Newton's method for one branch point halves its error
    a step there, and orbits beside it are found on the branches that cross."""
    calls = []

    def residual(z, p):
        calls.append(1)
        return np.array(three(z, p["r"]))

    names = ["u0", "v0", "u1", "v1", "u2", "v2"]
    if written:
        made = three(sympy.symbols(names), sympy.Symbol("r"))
        equations = {name: str(one).replace("**", "^") for name, one in zip(names, made, strict=True)}
        model = contin.load(
            {"name": "c", "states": dict.fromkeys(names, 0.0), "parameters": {"r": 0.35}, "equations": equations}
        )
    else:
        model = contin.FunctionProblem(residual, np.zeros(6), {"r": 0.35}, states=names)
    times = np.linspace(0.0, 2 * np.pi / (1 + SHIFT * 0.35), 21)
    angle = (1 + SHIFT * 0.35) * times
    circle = np.sqrt(0.35) * np.column_stack([np.cos(angle), np.sin(angle)])
    orbit = contin.periodic_orbit(model, np.tile(circle, 3), times=times, intervals=8)
    branch = contin.continuation(orbit, "r", (0.35, 0.5), settings={"intervals": 8, "step": 0.3, "max_step": 0.5})
    assert [(p.label, p.vectors["kernel"]) for p in branch.points] == [("BPC1", 2)]
    exact = 0.24 * (1 + DISPERSED**2) / (2 * (DISPERSED * SHIFT - 1))
    point = branch["BPC1"]
    assert abs(point.values["r"] - exact) <= point.error < 1e-6
    assert [note for note in branch.notes if "2 multipliers pass 1 at once" in note] == list(branch.notes)
    assert branch.columns["unstable"][0] == 0
    assert branch.columns["unstable"][-1] == 2
    assert len(calls) < 150_000
