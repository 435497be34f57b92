"""Hopf points with a symmetry: three patterns of three coupled cells (Golubitsky, Stewart, Schaeffer, ch. XVIII)."""

import numpy as np
import pytest

from contin import api
from contin.model.model import Model
from contin.problems.orbits.special_orbits.defining import solve_special


def ring():
    """v' = l v - w - v^3 + k (sum of neighbours - 2 v), w' = v: in phase from l = 0, other patterns from l = 3 k."""
    cells = {}
    for i in (1, 2, 3):
        j, m = i % 3 + 1, (i + 1) % 3 + 1
        cells |= {f"v{i}": f"l*v{i} - w{i} - v{i}^3 + 0.3*(v{j} + v{m} - 2*v{i})", f"w{i}": f"v{i}"}
    rotate = {f"{x}{i}": f"{x}{i % 3 + 1}" for x in "vw" for i in (1, 2, 3)}
    swap = {"v1": "v2", "w1": "w2", "v2": "v1", "w2": "w1"}
    return Model(
        "cells", states=dict.fromkeys(cells, 0.0), parameters={"l": -0.5}, equations=cells,
        symmetries={"rotate": rotate, "swap": swap},
    )  # fmt: skip


def test_rotating_wave_and_the_two_patterns_of_oscillation_of_three_coupled_cells():
    line = api.continuation(api.equilibrium(ring()), "l", (-0.5, 1.6))
    assert [p.values["l"] for p in line.points] == pytest.approx([0.0, 0.9], abs=1e-10)
    seeds = line["HB2"].switch()
    assert len(seeds) == 3
    families = [api.continuation(seed, "l", (-0.5, 1.6), values={"l": [1.5]}) for seed in seeds]
    orbits = [family.problem.profile(family["UZ1"].z) for family in families]
    kinds = {}
    for family, orbit in zip(families, orbits, strict=True):
        assert family.ends[1].reason == "bound"
        tops = np.array([family["UZ1"].values[f"v{i}.max"] for i in (1, 2, 3)])
        equal = np.sum(np.abs(tops - np.roll(tops, 1)) < 1e-5 * tops.max())
        kinds["wave" if equal == 3 else "silent" if tops.min() < 1e-8 else "pair"] = orbit
    assert set(kinds) == {"wave", "silent", "pair"}
    times = np.linspace(0.0, 1.0, 50)
    wave = kinds["wave"]
    shifts = [np.abs(wave.at((times + s) % 1.0)[:, 2] - wave.at(times)[:, 0]).max() for s in (1 / 3, 2 / 3)]
    assert min(shifts) < 1e-5  # one cell is a third of a period ahead of the next
    pair = kinds["pair"].u.reshape(-1, 3, 2)
    gaps = [np.abs(pair[:, i] - pair[:, j]).max() for i, j in ((0, 1), (1, 2), (2, 0))]
    assert min(gaps) < 1e-8
    # v3 = 0, v1 = -v2 is one cell alone with l - 3 k: as all cells in phase there
    alone = api.continuation(line["HB1"].switch()[0], "l", (-0.5, 1.6), values={"l": [0.6]})
    assert kinds["silent"].period == pytest.approx(alone["UZ1"].values["period"], rel=1e-9)


def test_diagram_follows_every_pattern_once():
    diagram = api.diagram(ring(), "l", (-0.5, 1.2))
    names = [b.name for b in diagram if b.kind == "orbit"]
    assert names == ["start/HB1", "start/HB2", "start/HB2.2", "start/HB2.3"]
    assert all(b.ends[1].reason == "bound" for b in diagram if b.kind == "orbit")


def all_to_all(n=3):
    """w_i' = (mu + i) w_i - (1 - i/2) |w_i|^2 w_i + c sum_j (w_j - w_i): in step |w|^2 = mu, and differences of the
    amplitudes decay with 2 mu + n c (of the phases with n c), so that for c = -0.1 n - 1 multipliers pass 1 at
    mu = n/20.
    """
    equations, cells = {}, range(1, n + 1)
    sums = {x: " + ".join(f"{x}{i}" for i in cells) for x in "xy"}
    for i in cells:
        square = f"(x{i}^2 + y{i}^2)"
        growth, turn = f"(mu + {n / 10} - {square})", f"(1 + {square}/2)"  # n/10 = -n c
        equations[f"x{i}"] = f"{growth}*x{i} - {turn}*y{i} - 0.1*({sums['x']})"
        equations[f"y{i}"] = f"{growth}*y{i} + {turn}*x{i} - 0.1*({sums['y']})"
    rotate = {f"{x}{i}": f"{x}{i % n + 1}" for x in "xy" for i in cells}
    swap = {"x1": "x2", "y1": "y2", "x2": "x1", "y2": "y1"}
    return Model(
        "all-to-all", states=dict.fromkeys(equations, 0.0), parameters={"mu": -0.1}, equations=equations,
        symmetries={"rotate": rotate, "swap": swap},
    )  # fmt: skip


def in_step(stop, n=3):
    """The family of orbits on which all cells are equal."""
    line = api.continuation(api.equilibrium(all_to_all(n)), "mu", (-0.2, 1.0))
    return api.continuation(line["HB1"].switch()[0], "mu", (-0.2, stop))


def test_cells_in_step_lose_their_stability_to_two_against_one():
    """Symmetry gives one family where two multipliers pass 1, up to images: two cells against one."""
    together = in_step(0.5)
    (point,) = together.points
    assert (point.type, point.normal_form["kernel"]) == ("BPC", 2)
    assert abs(point.values["mu"] - 0.15) <= point.error < 1e-5  # a double zero: half of the digits
    assert np.sum(np.abs(point.eigenvalues - 1.0) < 30 * point.error) == 3  # with the trivial one; |d/dmu| = 23
    (seed,) = point.switch()
    apart = api.continuation(seed, "mu", (0.1, 0.5), values={"mu": [0.3]})
    for label in [p for p in apart.points if p.type == "UZ"]:
        cells = apart.problem.profile(label.z).u.reshape(-1, 3, 2)
        gaps = sorted(float(np.abs(cells[:, i] - cells[:, j]).max()) for i, j in ((0, 1), (1, 2), (2, 0)))
        assert gaps[0] < 1e-7 < 1e-2 < gaps[1]
    assert any(p.type == "UZ" for p in apart.points)


@pytest.mark.parametrize(("n", "families"), [(4, 2), pytest.param(5, 2, marks=pytest.mark.seldom)])
def test_products_of_many_symmetries_tell_families_too(n, families):
    """All splittings of the cells into two groups: of two and two, and of two and three, by (12)(34) and (12)(345)."""
    (point,) = in_step(0.3, n).points
    assert (point.type, point.normal_form["kernel"]) == ("BPC", n - 1)
    assert abs(point.values["mu"] - n / 20) <= point.error < 1e-5
    assert len(point.switch()) == families


def test_the_error_of_a_double_multiplier_holds_wherever_newton_begins():
    """Two multipliers at 1 are found to half of the digits: where in them rounding leaves Newton is chance, and the
    stated error must cover it."""
    family = in_step(0.2)
    point = family["BPC1"]
    random = np.random.default_rng(3)
    for size in 10.0 ** -np.arange(4.0, 10.0):
        z = point.z + size * point.scale * random.uniform(-1.0, 1.0, point.z.size) / np.sqrt(point.z.size)
        found = solve_special(family.problem, "BPC", z, point.scale)
        assert abs(found.z[-1] - 0.15) <= found.error < 1e-5


def test_multipliers_that_pass_fast_are_counted_where_symmetry_makes_them_equal():
    """Brusselators in step: two multipliers pass 1 and, 6e-5 later, -1. The place of the first is off by 7e-8, which
    leaves them 1e-3 from 1; families of two against one are transcritical (Golubitsky and Stewart)."""
    cells = (0, 1, 2)
    equations = {}
    for i in cells:
        x, y = (f"({' + '.join(f'({v}{j} - {v}{i})' for j in cells if j != i)})" for v in "xy")
        inflow = f"0.0159*{x} + 0.0385*{y} - 0.163*(x0^2 + x1^2 + x2^2 - 3*x{i}^2)"
        equations[f"x{i}"] = f"0.989 - (p + 1)*x{i} + x{i}^2*y{i} + {inflow}"
        equations[f"y{i}"] = f"p*x{i} - x{i}^2*y{i} - 0.3755*{x} + 0.0529*{y}"
    rotate = {f"{v}{i}": f"{v}{(i + 1) % 3}" for v in "xy" for i in cells}
    swap = {"x0": "x1", "y0": "y1", "x1": "x0", "y1": "y0"}
    model = Model(
        "in step", states={x: 0.989 if x[0] == "x" else 1.0 for x in equations}, parameters={"p": 0.99},
        equations=equations, symmetries={"rotate": rotate, "swap": swap},
    )  # fmt: skip
    line = api.continuation(api.equilibrium(model), "p", (0.9, 2.0))
    family = api.continuation(line["HB1"].switch()[0], "p", (1.9, 4.14))
    assert [p.type for p in family.points] == ["BPC", "PD"]
    for point, critical in zip(family.points, (1.0, -1.0), strict=True):
        near = np.sort_complex(np.asarray(point.eigenvalues))[[0, 1] if critical < 0 else [-1, -2]]
        assert abs(near[1] - near[0]) < 1e-6
        assert np.all(np.abs(near - critical) < 1e-2)
        assert point.values["unstable"] == 0
    fork, flip = family.points
    assert fork.normal_form["kernel"] == 2
    assert fork.normal_form["kind"] == "transcritical"
    assert fork.normal_form["slope"] > 100 * fork.normal_form["errors"]["slope"]
    assert flip.vectors["kernel"] == 2
    assert "criticality" not in flip.normal_form
    assert any("2 multipliers pass -1 at once" in note for note in family.notes)
