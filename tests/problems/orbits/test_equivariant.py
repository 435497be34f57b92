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


def all_to_all():
    """w_i' = (mu + i) w_i - (1 - i/2) |w_i|^2 w_i + c sum_j (w_j - w_i): in step |w|^2 = mu, and differences of the
    amplitudes decay with 2 mu + 3 c (of the phases with 3 c), so that for c = -0.1 two multipliers pass 1 at mu = 0.15.
    """
    equations = {}
    for i in (1, 2, 3):
        square = f"(x{i}^2 + y{i}^2)"
        growth, turn = f"(mu + 0.3 - {square})", f"(1 + {square}/2)"  # 0.3 = -3 c
        equations[f"x{i}"] = f"{growth}*x{i} - {turn}*y{i} - 0.1*(x1 + x2 + x3)"
        equations[f"y{i}"] = f"{growth}*y{i} + {turn}*x{i} - 0.1*(y1 + y2 + y3)"
    rotate = {f"{x}{i}": f"{x}{i % 3 + 1}" for x in "xy" for i in (1, 2, 3)}
    swap = {"x1": "x2", "y1": "y2", "x2": "x1", "y2": "y1"}
    return Model(
        "all-to-all", states=dict.fromkeys(equations, 0.0), parameters={"mu": -0.1}, equations=equations,
        symmetries={"rotate": rotate, "swap": swap},
    )  # fmt: skip


def in_step(stop):
    """The family of orbits on which all cells are equal."""
    line = api.continuation(api.equilibrium(all_to_all()), "mu", (-0.2, 1.0))
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
