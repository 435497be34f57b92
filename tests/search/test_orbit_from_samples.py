"""Orbits from samples of one period, against closed forms."""

import csv
import json
from dataclasses import replace

import numpy as np
import pytest

import contin
from contin.cli.main import main
from contin.errors import InputError, NoSolutionError
from contin.search import orbit_by_simulation
from contin.search.orbit_by_simulation import _covered

# r' = r (b + r^2), angle' = 1: for b < 0 an unstable cycle of radius sqrt(-b) and period 2 pi
UNSTABLE = {
    "contin": 1,
    "name": "unstable",
    "states": {"x": 1.0, "y": 0.0},
    "parameters": {"b": {"value": -1.0, "range": [-2, 0]}},
    "equations": {"x": "b*x - y + x*(x^2 + y^2)", "y": "x + b*y + y*(x^2 + y^2)"},
}
TURN = np.linspace(0.0, 2 * np.pi, 41)


def test_a_rough_unstable_orbit_is_solved_for():
    rough = np.round(np.stack([1.02 * np.cos(TURN), 0.99 * np.sin(TURN)], axis=1), 2)
    orbit = contin.periodic_orbit(contin.load(UNSTABLE), rough, period=6.2)
    assert orbit.profile.period == pytest.approx(2 * np.pi, rel=1e-9)
    assert np.linalg.norm(orbit.profile.u, axis=1) == pytest.approx(1.0, abs=1e-7)


def test_samples_of_a_forced_system_may_begin_at_any_time():
    """x'' + c x' + k x = cos(w t): the response is Re(e^(iwt) / (k - w^2 + i c w))."""
    c, k, w = 0.3, 2.0, 1.7
    model = contin.Model(
        "forced", states={"x": 0.0, "v": 0.0}, parameters={"k": k}, forcing={"period": f"2*pi/{w}"},
        equations={"x": "v", "v": f"cos({w}*t) - {c}*v - k*x"},
    )  # fmt: skip
    gain = 1.0 / (k - w * w + 1j * c * w)

    def exact(t):
        return np.stack([(gain * np.exp(1j * w * t)).real, (1j * w * gain * np.exp(1j * w * t)).real], axis=-1)

    for turns in (1, 2):
        t = 0.83 + np.linspace(0.0, turns * 2 * np.pi / w, 60 * turns)
        orbit = contin.periodic_orbit(model, exact(t), times=t)
        assert orbit.multiple == turns
        assert orbit.profile.u == pytest.approx(exact(orbit.profile.times * orbit.profile.period), abs=1e-7)
    with pytest.raises(InputError, match=r"span 1\.5 forcing periods"):
        contin.periodic_orbit(model, exact(t), times=np.linspace(0.0, 3 * np.pi / w, len(t)))


def test_an_angle_keeps_its_turns():
    """theta' = w + a sin(theta): period 2 pi / sqrt(w^2 - a^2)."""
    w, a = 2.0, 1.0
    model = contin.Model(
        "rotation", states={"theta": {"value": 0.0, "period": "2*pi"}}, parameters={"w": w},
        equations={"theta": f"w + {a}*sin(theta)"},
    )  # fmt: skip
    orbit = contin.periodic_orbit(model, np.linspace(0.0, 2 * np.pi, 30)[:, None], period=3.5)
    assert orbit.profile.period == pytest.approx(2 * np.pi / np.sqrt(w * w - a * a), rel=1e-8)
    assert orbit.profile.u[-1] - orbit.profile.u[0] == pytest.approx(2 * np.pi)


def test_samples_of_nothing_are_refused():
    with pytest.raises(NoSolutionError, match=r"not near a periodic orbit|lead to an equilibrium"):
        contin.periodic_orbit(contin.load(UNSTABLE), np.ones((20, 2)) * 1e-3, period=1.0)
    with pytest.raises(InputError, match="one entry for each"):
        contin.periodic_orbit(contin.load(UNSTABLE), np.ones((20, 2)), times=[0.0, 1.0])


def write(folder, samples, header=("t", "extra", "y", "x"), name="orbit.csv", run_samples=None):
    with (folder / name).open("w", newline="") as stream:
        writer = csv.writer(stream)
        writer.writerow(header)
        writer.writerows(samples)
    continuations = [{"name": "cycles", "samples": run_samples or name, "parameter": "b"}]
    (folder / "run.yaml").write_text(json.dumps({"contin": 1, "model": UNSTABLE, "continuations": continuations}))
    return ["run", str(folder / "run.yaml"), "--json", str(folder / "out.json"), "--quiet"]


def test_a_run_begins_with_samples_in_a_file(tmp_path):
    rows = [(t, 7.0, np.sin(t), np.cos(t)) for t in TURN]
    with pytest.raises(SystemExit) as stopped:
        main(write(tmp_path, rows))
    assert stopped.value.code == 0
    (branch,) = json.loads((tmp_path / "out.json").read_text())["branches"]
    assert branch["kind"] == "orbit"
    b, radius = np.array(branch["columns"]["b"]), np.array(branch["columns"]["x.max"])
    # r^2 = -b to the error of collocation; in the last row, the Hopf point, b is zero up to rounding of either sign
    assert radius**2 == pytest.approx(-b, abs=1e-7)
    assert branch["ends"][0]["reason"] == "bound"
    assert branch["ends"][1]["reason"] == "hopf"


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"header": ("t", "extra", "y", "z")}, "has no column 'x'"),
        ({"run_samples": "../orbit.csv"}, "must stay in or below"),
        ({"run_samples": "missing.csv"}, "cannot be read"),
        ({"run_samples": "orbit.txt"}, "must end in .csv"),
        ({"samples": [(1.0, 0.0, 0.0, 1.0)]}, "has 1 samples"),
        ({"samples": [(0.0, 0.0, "much", 1.0)] * 20}, "no numbers in line 2"),
        ({"samples": [(0.0, 0.0, 1.0, 1.0)] * 20}, "times t that grow"),
    ],
)
def test_a_file_that_is_no_orbit_is_named(tmp_path, capsys, change, words):
    arguments = {"samples": [(t, 0.0, np.sin(t), np.cos(t)) for t in TURN], **change}
    with pytest.raises(SystemExit) as stopped:
        main(write(tmp_path, **arguments))
    assert stopped.value.code == 2
    message = capsys.readouterr().err
    assert words in message
    assert "continuations" in message or "samples" in message


def test_response_that_has_settled_is_not_taken_for_a_subharmonic_one():
    """x'' + d x' - x + x^3 = g cos t, small in one well: one forcing period, however closely nine of them return."""
    model = contin.Model(
        "holmes", states={"x": 1.0, "y": 0.0}, parameters={"g": 0.05, "d": 0.15}, forcing={"period": "2*pi"},
        equations={"x": "y", "y": "x - x^3 - d*y + g*cos(t)"},
    )  # fmt: skip
    assert contin.periodic_orbit(model).period == pytest.approx(2.0 * np.pi, rel=1e-12)


def test_a_response_that_closed_best_after_seven_periods_is_one_on_a_coarse_mesh_too(monkeypatch):
    """x'' + x/4 + d x' = (1/4 - 1) cos t - d sin t, x = cos t: seven periods on twelve intervals do not look alike."""
    model = contin.Model(
        "driven", states={"x": 1.0, "y": 0.0}, parameters={"d": 0.5}, forcing={"period": "2*pi"},
        equations={"x": "y", "y": "-x/4 - d*y - 0.75*cos(t) - d*sin(t)"},
    )  # fmt: skip
    assert contin.periodic_orbit(model).period == pytest.approx(2.0 * np.pi, rel=1e-12)  # y is zero at every period
    find = orbit_by_simulation.find_return

    def seven(*arguments):
        near = find(*arguments)
        return replace(near, period=7.0 * near.period / near.multiple, multiple=7)

    monkeypatch.setattr(orbit_by_simulation, "find_return", seven)
    orbit = contin.periodic_orbit(model, {"x": 1.0, "y": 0.0}, intervals=12)
    assert (orbit.multiple, orbit.period) == (1, pytest.approx(2.0 * np.pi, rel=1e-12))


@pytest.mark.parametrize("rest", [0.0, 1e-17])
def test_a_state_at_rest_up_to_rounding_does_not_hide_that_a_response_repeats(rest):
    """x = cos t through three periods of the forcing, beside a state that has died out."""
    model = contin.Model(
        "driven", states={"x": 1.0, "y": 0.0, "z": rest}, parameters={"d": 0.5}, forcing={"period": "2*pi"},
        equations={"x": "y", "y": "-x - d*(y + sin(t))", "z": "-z"},
    )  # fmt: skip
    t = np.linspace(0.0, 6.0 * np.pi, 121)
    noise = rest * np.random.default_rng(0).normal(size=t.size)
    orbit = contin.periodic_orbit(model, np.column_stack([np.cos(t), -np.sin(t), 0.0 * t]), times=t)
    u = orbit.profile.at(orbit.profile.times)
    u[:, 2] = np.interp(orbit.profile.times, t / t[-1], noise)
    assert _covered(replace(orbit, profile=replace(orbit.profile, u=u), multiple=3), 1, np.zeros(3)) == 3
    u[:, 0] += 1e-3 * np.cos(2.0 * np.pi * orbit.profile.times)
    assert _covered(replace(orbit, profile=replace(orbit.profile, u=u), multiple=3), 1, np.zeros(3)) == 1
