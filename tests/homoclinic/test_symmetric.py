"""Connecting orbits of reversible flows that their reversor maps onto themselves, against closed forms."""

import numpy as np
import pytest

import contin
from contin.errors import InputError

SWIFT = contin.Model(
    "swift-hohenberg", states={"u": 0, "v": 0, "w": 0, "y": 0}, parameters={"P": "-13/6"},
    equations={"u": "v", "v": "w", "w": "y", "y": "-P*w - u + u^2"},
)  # fmt: skip
EVEN = {"v": "-v", "y": "-y"}


@pytest.mark.seldom
def test_a_pulse_of_the_fourth_order_equation_in_closed_form():
    """u'''' + P u'' + u - u^2 = 0 at P = -13/6: u = 35/24 sech(t / sqrt 24)^4 (Buffoni, Champneys and Toland 1996)."""
    start = contin.connection(SWIFT, {"u": 0}, reversor=EVEN)
    branch = contin.continuation(start, "P", (-2.4, 1.5), values={"P": [-13 / 6]}, settings={"max_step": 0.5})
    assert (branch.kind, [end.reason for end in branch.ends]) == ("connection", ["bound", "bound"])
    point = branch["UZ1"]
    assert point.values["u.max"] == pytest.approx(35 / 24, abs=1e-9)
    orbit = point.orbit
    t, u = np.asarray(orbit.t), np.asarray(orbit.columns["u"])
    exact = 35 / 24 / np.cosh((t - t[-1] / 2) / np.sqrt(24)) ** 4
    assert np.abs(u - exact).max() < 1e-8  # both halves


@pytest.mark.seldom
def test_solitary_waves_in_two_parameters_where_the_origin_is_a_saddle_centre():
    """Demo kdv of AUTO: u = 3 (b + 1/2) sech^2 for a = 3/5 (2b + 1)(b - 2) (Champneys and Groves 1997)."""
    kdv = contin.Model(
        "kdv", states={"q1": 0, "p1": 0, "q2": 0, "p2": 0}, parameters={"a": -1.7, "b": 1.0},
        equations={"q1": "q2", "p1": "1.5*q1^2 + a*q1 - 0.5*q2^2", "q2": "7.5*p2", "p2": "-p1 + b*q2 - q1*q2"},
    )  # fmt: skip
    start = contin.connection(kdv, {"q1": 0}, reversor={"p1": "-p1", "q2": "-q2"})
    branch = contin.continuation(start, ("a", "b"), {"a": (-2.2, -0.1), "b": (0.5, 1.9)})
    a, b = branch.columns["a"], branch.columns["b"]
    assert np.abs(a - 0.6 * (2 * b + 1) * (b - 2)).max() < 1e-6
    assert np.abs(branch.columns["q1.max"] - 1.5 * (2 * b + 1)).max() < 1e-6
    assert np.ptp(b) == pytest.approx(1.4)


def test_a_kink_leads_to_the_image_of_its_saddle():
    """u'' = k (u^3 - u): u = tanh(sqrt(k/2) t), largest slope sqrt(k/2)."""
    kink = contin.Model(
        "kink", states={"u": -1, "v": 0}, parameters={"k": 1.0}, equations={"u": "v", "v": "k*(u^3 - u)"}
    )
    branch = contin.continuation(contin.connection(kink, {"u": -1}, reversor={"u": "-u"}), "k", (0.5, 2))
    assert branch.columns["v.max"] == pytest.approx(np.sqrt(branch.columns["k"] / 2), abs=1e-9)
    assert branch.columns["u.max"].min() > 0.999


@pytest.mark.seldom
def test_two_pulses_from_samples_end_at_a_fold():
    """Of u'''' + P u'' + u - u^3 = 0 (demo rev of AUTO): the orbit from two pulses turns back; a finer orbit agrees."""
    cubic = contin.Model(
        "rev", states={"u": 0, "v": 0, "w": 0, "y": 0}, parameters={"P": 1.0},
        equations={"u": "v", "v": "w", "w": "y", "y": "-P*w - u + u^3"},
    )  # fmt: skip
    one = contin.continuation(
        contin.connection(cubic, {"u": 0}, reversor=EVEN), "P", (0.99, 1.01), values={"P": [1.0]}
    )["UZ1"].orbit
    t, u = np.asarray(one.t), np.stack([one.columns[name] for name in "uvwy"], axis=1)
    middle, apart = t[-1] / 2, 2.1
    times = np.linspace(-middle - apart, 0, 600)

    def pulse(x):
        return np.stack([np.interp(x + middle, t, column, left=0, right=0) for column in u.T], axis=1)

    samples = (times - times[0], pulse(times + apart) + pulse(times - apart))
    folds = []
    for truncation in (1e-5, 1e-6):
        start = contin.connection(cubic, {"u": 0}, samples=samples, reversor=EVEN, truncation=truncation)
        settings = {"steps": 40, "step": 0.1, "max_step": 0.5}
        branch = contin.continuation(start, "P", (0.9, 1.99), direction="up", settings=settings)
        folds.append((branch["LP1"].values["P"], branch["LP1"].error))
        assert branch.unexplained == 0  # the saddle's unstable directions are the same before and behind the fold
    assert abs(folds[0][0] - folds[1][0]) <= folds[0][1] + folds[1][1] + 1e-8


@pytest.mark.parametrize(
    ("reversor", "words"),
    [
        ({"v": "-v"}, "not reversible"),
        ({"v": "-v", "y": "-y^2"}, "linear"),
        ({"v": "-v", "y": "2*y"}, "involution"),
        ({"q": "-q"}, "no state"),
        ({"v": "-("}, "v: "),
    ],
)
def test_a_reversor_that_is_none_is_named(reversor, words):
    with pytest.raises(InputError, match=words):
        contin.connection(SWIFT, {"u": 0}, reversor=reversor)


def test_how_many_parameters_symmetric_orbits_need_is_said():
    model = contin.Model(
        "two", states={"u": 0, "v": 0}, parameters={"k": 1.0, "m": 1.0}, equations={"u": "v", "v": "m*u - k*u^3"}
    )
    start = contin.connection(model, {"u": 0}, reversor={"v": "-v"})
    with pytest.raises(InputError, match="name one parameter"):
        contin.continuation(start, ("k", "m"), {"k": (0.5, 2), "m": (0.5, 2)})
