"""Demos of AUTO-07p whose numbers nobody prints: against literature, or another method from the same point."""

import json
from math import atan, pi, sin

import numpy as np
import pytest
from scipy.integrate import solve_bvp, solve_ivp

from tests.cli.auto_demos.results import FOLDER
from tests.cli.calls import call


def found_by(name, folder, *options, run=None):
    out = folder / "out.json"
    call("run", str(run or FOLDER / f"{name}.yaml"), "--quiet", *options, "--json", str(out))
    return {branch["name"]: branch for branch in json.loads(out.read_text())["branches"]}


def labelled(branch, type_):
    return [p for p in branch["points"] if p["type"] == type_]


def test_cycles_of_chuas_circuit_double_where_their_monodromy_matrix_says_so(tmp_path):
    """chu: by Dormand and Prince's method the orbit closes, and has the multiplier -1."""
    branches = found_by("chu", tmp_path, "--orbits")
    points = [p for name in ("cycles", "doubled") for p in labelled(branches[name], "PD")]
    assert len(points) >= 2
    for point in points:
        alpha, start = point["values"]["alpha"], [point["orbit"][name][0] for name in "xyz"]

        def rates(_, w, alpha=alpha):
            x, y, z = w[:3]
            h, slope = 2 / 7 * x, 2 / 7
            for sign in (1, -1):
                s = x + sign
                h -= sign * 3 / 14 * 2 / pi * s * atan(10 * s)
                slope -= sign * 3 / 14 * 2 / pi * (atan(10 * s) + 10 * s / (1 + 100 * s * s))
            matrix = np.array([[-alpha * slope, alpha, 0], [1, -1, 1], [0, -14.3, 0]])
            return np.concatenate([[alpha * (y - h), x - y + z, -14.3 * y], (matrix @ w[3:].reshape(3, 3)).ravel()])

        whole = np.concatenate([start, np.eye(3).ravel()])
        end = solve_ivp(rates, (0, point["values"]["period"]), whole, "DOP853", rtol=1e-11, atol=1e-12).y[:, -1]
        assert end[:3] == pytest.approx(start, abs=1e-5)
        assert np.abs(np.linalg.eigvals(end[3:].reshape(3, 3)) + 1).min() < 1e-4


def test_a_forced_cell_responds_as_a_trajectory_does(tmp_path):
    """frc at bet = 50: the response closes after a period of the forcing."""
    (point,) = labelled(found_by("frc", tmp_path, "--orbits")["frequency"], "UZ")

    def rates(t, y):
        v, w = y
        return [(v * (v - 0.5) * (1 - v) - w) / 0.005, v - w - 0.5 - 0.2 * sin(50 * t)]

    start = [point["orbit"][name][0] for name in "vw"]
    end = solve_ivp(rates, (0, 2 * pi / 50), start, "DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
    assert end == pytest.approx(start, abs=1e-6)


@pytest.mark.parametrize("steps", [200, pytest.param(1200, marks=pytest.mark.long)])
@pytest.mark.seldom
def test_swirling_flow_turns_where_the_literature_has_it(steps, tmp_path):
    """kar: folds of Zandbergen and Dijkstra (1977); Karman's disc draws in 0.88447411 (Rogers and Lance 1960).

    After its first 120 of 1,200 steps the run winds up in ever smaller turns, which no line here asks for.
    """
    text = (FOLDER / "kar.yaml").read_text()
    assert "steps: 1200" in text
    (tmp_path / "kar.yaml").write_text(text.replace("steps: 1200", f"steps: {steps}"))
    flows = found_by("kar", tmp_path, run=tmp_path / "kar.yaml")["flows"]
    folds = [p["values"]["g"] for p in labelled(flows, "LP")][::-1]  # the branch runs down from g = 1
    assert folds[:2] == pytest.approx([-0.16053876, 0.07452563], abs=1e-8)
    assert labelled(flows, "UZ")[-1]["values"]["f"] == pytest.approx(0.88447411 / 2, abs=1e-6)


@pytest.mark.seldom
def test_layers_are_those_of_another_solver(tmp_path):
    """spb at eps = 1e-3: scipy's collocation stays at the solution, at the mesh points (every fourth node)."""
    points = labelled(found_by("spb", tmp_path, "--orbits")["ends"], "UZ")
    assert [p["values"]["gam"] for p in points] == pytest.approx([-1, 1], abs=1e-9)
    for point in points:
        gam, orbit = point["values"]["gam"], {k: np.array(v) for k, v in point["orbit"].items()}
        rates = lambda x, y: [y[1], (y[0] * y[1] * (y[0] ** 2 - 1) + y[0]) * 1e3]  # noqa: E731
        ends = lambda a, b, gam=gam: [a[0] - 1.5, b[0] - gam]  # noqa: E731
        keep = np.append(np.diff(orbit["t"]) > 0, True)
        guess = np.array([orbit["u"], orbit["v"]])[:, keep]
        other = solve_bvp(rates, ends, orbit["t"][keep], guess, tol=1e-6, max_nodes=20000)
        assert other.success
        assert other.y[1, 0] == pytest.approx(point["values"]["v.start"], rel=1e-5)
        assert np.abs(other.sol(orbit["t"][::4])[0] - orbit["u"][::4]).max() < 1e-6


@pytest.mark.seldom
def test_halo_orbits_are_those_of_howells_table(tmp_path):
    """r3b at mass ratio 0.04: Lyapunov's and the vertical orbits leave the libration point with half the periods of its
    modes; halo orbits (x, z, y', T/2) as in Howell (1984), table I."""
    branches = found_by("r3b", tmp_path)
    m, x = 0.04, branches["point"]["columns"]["x.start"][0]
    c = (1 - m) / (x + m) ** 3 + m / (1 - m - x) ** 3
    planar = (2 - c + (9 * c * c - 8 * c) ** 0.5) / 2  # frequency^2
    half = sorted([pi / planar**0.5, pi / c**0.5])
    assert [p["values"]["T"] for p in labelled(branches["point"], "BP")] == pytest.approx(half, abs=1e-9)
    names = ("x.end", "z.end", "v.end", "T")
    seen = [[p["values"][name] for name in names] for p in labelled(branches["halo"], "UZ")]
    for row in ([0.723268, -0.04, 0.198019, 1.300177], [0.801125, -0.299382, 0.312474, 1.017241]):
        assert min(np.abs(np.array(one) - row).max() for one in seen) < 2e-6


def test_the_unstable_manifold_of_a_lyapunov_orbit_keeps_its_energy_and_comes_from_it(tmp_path):
    """r3bm: Jacobi's constant along both sheets, and trajectories backwards to where the cycle is."""
    branches = found_by("r3bm", tmp_path, "--orbits")
    m, sheets = 0.04, branches["sheets"]["columns"]
    x, y, u, v, orbit = (np.array(sheets[name]) for name in ("x", "y", "u", "v", "orbit"))
    cycle = branches["lyapunov"]["points"][-1]["orbit"]
    path = np.array([cycle[name] for name in "xyuv"]).T

    def jacobi(x, y, u, v):
        return x * x + y * y + 2 * (1 - m) / np.hypot(x + m, y) + 2 * m / np.hypot(x - 1 + m, y) - u * u - v * v

    assert np.abs(jacobi(x, y, u, v) - jacobi(*path[0])).max() < 1e-7

    def back(_, w):
        a, b = (1 - m) / np.hypot(w[0] + m, w[1]) ** 3, m / np.hypot(w[0] - 1 + m, w[1]) ** 3
        rates = [w[2], w[3], 2 * w[3] + w[0] - a * (w[0] + m) - b * (w[0] - 1 + m), -2 * w[2] + w[1] - (a + b) * w[1]]
        return -np.array(rates)

    for number in (0, 7):
        last = np.flatnonzero(orbit == number)[60]
        found = solve_ivp(back, (0, 3), [x[last], y[last], u[last], v[last]], method="DOP853", rtol=1e-11, atol=1e-13)
        gaps = np.abs(path[:, None] - found.y.T[None]).max(axis=2).min(axis=0)
        assert gaps.min() < 1e-3
        assert gaps[0] > 10 * gaps.min()
