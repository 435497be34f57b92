"""AUTO's demo fnc: orbits on the slow manifolds of a folded node, beside trajectories."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from tests.cli.auto_demos.results import branches_of

TIGHT = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-13}
SECTION = 0.3  # of s, between both sheets: the folded node is at 0.2797


def rate(_: float, u: np.ndarray, eps: float) -> list[float]:
    v, h, s = u
    return [h - (v**3 - v + 1) / 2 - s * v / 2, -eps * (2 * h + 2.6 * v), -0.565 * eps * s]


def at_the_section(u: np.ndarray, eps: float, time: float) -> np.ndarray:
    """Where a trajectory (backwards for negative times) has s = SECTION."""
    until = np.log(u[2] / SECTION) / (0.565 * eps)
    assert 0.0 < until / time < 1.0
    return solve_ivp(rate, (0.0, until), u, args=(eps,), **TIGHT).y[:, -1]


@pytest.fixture(scope="module")
def branches():
    return branches_of("fnc")


@pytest.mark.seldom
def test_the_attracting_slow_manifold_is_made_of_trajectories(branches):
    (point,) = branches["sheet"]["points"]
    values = point["values"]
    start = [values[f"{name}.start"] for name in "vhs"]
    end = solve_ivp(rate, (0.0, values["T"]), start, args=(values["eps"],), **TIGHT).y[:, -1]
    assert end == pytest.approx([values[f"{name}.end"] for name in "vhs"], abs=1e-7)
    v, h, s = start
    assert (h, 2 * h - v**3 + v - 1 - s * v) == pytest.approx((-6, 0), abs=1e-9)


@pytest.mark.parametrize("name", ["ends", "canard"])
def test_a_canard_is_a_trajectory_from_either_end(branches, name):
    """Forwards on the attracting sheet, and backwards, where the repelling one attracts: they meet between the two."""
    point = next(p for p in branches[name]["points"] if p["type"] == "UZ")
    values = point["values"]
    first, last = ([values[f"{state}.{end}"] for state in "vhs"] for end in ("start", "end"))
    assert last[:2] == pytest.approx([0.0, 0.5], abs=1e-9)
    eps, time = values["eps"], values["T"]
    ahead, behind = at_the_section(np.array(first), eps, time), at_the_section(np.array(last), eps, -time)
    assert ahead == pytest.approx(behind, abs=1e-6)


def test_the_repelling_slow_manifold_is_made_of_trajectories_backwards():
    """From the middle of the critical manifold to the section through the folded node."""
    points = [p["values"] for b in branches_of("fncr").values() for p in b["points"] if p["type"] == "UZ"]
    assert len(points) == 3
    for values in points:
        start = np.array([values[f"{name}.start"] for name in "vhs"])
        until = np.log(start[2] / 0.2797) / (0.565 * values["eps"])
        assert until == pytest.approx(values["T"], rel=1e-9)
        end = solve_ivp(rate, (0.0, until), start, args=(values["eps"],), **TIGHT).y[:, -1]
        assert end == pytest.approx([values[f"{name}.end"] for name in "vhs"], abs=1e-8)
