"""The labels of planted branches of equilibria: each is found within its error, or a note says that it is not."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from tests.truth.ledger import Ledger
from tests.truth.planted_equilibria import Planted, crossings, folds, hopf_points, imperfect, mixed, tangency

SPACINGS = [10.0**-k for k in range(1, 13)]


def planted(seed: int, rounds: int, spacings: list[float], worst: float) -> Iterator[tuple[str, Planted]]:
    """(machine, system) of every kind; sizes and conditions up to 10^worst are drawn."""
    generator = np.random.default_rng(seed)
    for _ in range(rounds):
        for spacing in spacings:
            size, condition = int(generator.integers(1, 5)), 10.0 ** generator.uniform(0, worst)
            for count in (2, 3):
                yield f"{count} crossings", crossings(generator, spacing, count, size, condition)
                yield f"{count} Hopf points", hopf_points(generator, spacing, count)
            yield "three folds", folds(generator, spacing, size, condition)
            if spacing > 1e-7:  # beneath, the gap squared is lost in the rounding of the equations
                yield "imperfect crossings", imperfect(generator, spacing, int(generator.integers(1, 4)))
        for order in (2, 3, 4):
            size, condition = int(generator.integers(1, 5)), 10.0 ** generator.uniform(0, 3)
            yield "tangencies", tangency(generator, order, size, condition)


def judged(seed: int, rounds: int, spacings: list[float], worst: float) -> Ledger:
    ledger = Ledger()
    for machine, system in planted(seed, rounds, spacings, worst):
        try:
            branch = system.follow()
        except Exception as error:  # noqa: BLE001 - every failure is a row of the table
            ledger.failed(machine, f"{system.name}, seed {seed}", error)
            continue
        ledger.judge(machine, f"{system.name}, seed {seed}", branch, system.expected, "p", 1.14)
    return ledger


@pytest.mark.seldom
def test_planted_points_are_found_or_noted():
    judged(seed=1, rounds=1, spacings=SPACINGS[::4], worst=2.0).assert_clean()


@pytest.mark.seldom
def test_three_events_at_any_spacing_are_found_or_noted():
    """Two of them often lie in a step beside that of the third, where no sign changes."""
    ledger, generator = Ledger(), np.random.default_rng(1)
    for _ in range(12):
        spacing = 10.0 ** generator.uniform(-3, -1.5)
        for system in (folds(generator, spacing, 1, 1.0), hopf_points(generator, spacing, 3)):
            ledger.judge(system.name.split(" 1e")[0], system.name, system.follow(), system.expected, "p", 1.14)
    ledger.assert_clean()


@pytest.mark.parametrize("count", [12, pytest.param(300, marks=pytest.mark.long)])
@pytest.mark.seldom
def test_three_events_near_the_spacing_that_rounding_tells_apart_are_found_or_noted(count):
    """Zeros of a test within each other's rounding are one label with a note; one beside them is not lost for it."""
    ledger, generator = Ledger(), np.random.default_rng(12)
    for _ in range(count):
        size, condition = int(generator.integers(1, 4)), 10.0 ** generator.uniform(0, 3)
        systems = (
            folds(generator, 10.0 ** generator.uniform(-10, -4), size, condition),
            hopf_points(generator, 10.0 ** generator.uniform(-5, -3.5), 3),
        )
        for system in systems:
            ledger.judge(system.name.split(" 1e")[0], system.name, system.follow(), system.expected, "p", 1.14)
    ledger.assert_clean()


@pytest.mark.long
def test_planted_points_are_found_or_noted_in_many_systems(tmp_path):
    ledger = judged(seed=2026, rounds=12, spacings=SPACINGS, worst=5.0)
    ledger.write(tmp_path / "planted_equilibria.md", {"seed": "2026"})
    print(ledger.table())
    ledger.assert_clean()


def at_place(place: int, kind: int):
    """A system that was drawn in the long version: three folds (kind 0) or three Hopf points (1)."""
    generator = np.random.default_rng(12)
    for _ in range(place + 1):
        size, condition = int(generator.integers(1, 4)), 10.0 ** generator.uniform(0, 3)
        systems = (
            folds(generator, 10.0 ** generator.uniform(-10, -4), size, condition),
            hopf_points(generator, 10.0 ** generator.uniform(-5, -3.5), 3),
        )
    return systems[kind]


@pytest.mark.parametrize(("place", "kind", "labels"), [(228, 0, 0), (264, 0, 0), (282, 1, 1)])
def test_events_that_rounding_hides_are_one_label_or_none_and_the_branch_goes_on(place, kind, labels):
    """Flat folds had forty labels, or steps of 1e-8 until the steps ran out; Hopf points had one label and no note."""
    branch = at_place(place, kind).follow()
    assert len(branch.points) == labels
    assert branch.notes
    assert kind or branch.unexplained > 0
    assert len(branch.z) < 100
    assert {end.reason for end in branch.ends} == {"bound"}
    assert abs(branch.z[0] - branch.z[-1])[:-1].max() > 0.1 or kind


@pytest.mark.seldom
def test_a_tangency_is_found_wherever_the_rows_about_it_fall():
    """Beside a multiple branch point Newton fails; a trial as far from it on the other side was an ordinary minimum."""
    for k in range(0, 33, 3):
        r = 0.1875 + k / 1024
        branch = Planted("one", {"x": f"x*((p - {r!r})^2 - x)"}, {"x": 0.0}, [], (-1.0, 1.0), at=-1.0).follow()
        (point,) = branch.points
        assert abs(point.values["p"] - r) <= point.error
        assert point.normal_form["kind"] == "tangency"


@pytest.mark.parametrize("spacing", [3e-4, 3.8e-4, 4.5e-4])
def test_four_hopf_points_whose_growth_rate_is_lost_between_them_are_noted(spacing):
    """The count of unstable eigenvalues changes beside the outer two, where the rate is 2e-12: two labels, no word."""
    branch = hopf_points(np.random.default_rng(4711018), spacing, 4).follow()
    assert len(branch.points) == 4 or (branch.notes and branch.unexplained)


@pytest.mark.parametrize("spacing", np.geomspace(2e-7, 3e-6, 8))
def test_a_zero_at_the_distance_at_which_a_fold_is_looked_at_again_is_noted(spacing):
    """The test has the same sizes at both distances, but other signs: a third fold lies between them."""
    branch = folds(np.random.default_rng(1), float(spacing), 1, 1.0).follow()
    assert len(branch.points) == 3 or branch.notes


def test_errors_of_crossings_hold_in_skewed_coordinates():
    """Entries of the Jacobian are sums of terms up to the condition, which cancel and err alike wherever one looks."""
    found = 0
    for seed, spacing, count, size, condition in (
        (5035, 8e-3, 3, 2, 9e4), (1, 3e-2, 2, 4, 5e4), (2, 2e-3, 3, 4, 7e3), (3, 1e-2, 2, 3, 1e4), (4, 5e-2, 1, 3, 5e4),
        (5, 4e-2, 3, 2, 2e3), (6, 0.1, 3, 2, 1.0),
    ):  # fmt: skip
        planted = crossings(np.random.default_rng(seed), spacing, count, size, condition)
        places = [expected.at for expected in planted.expected]
        for point in planted.follow().points:
            found += 1
            assert min(abs(point.values["p"] - place) for place in places) <= point.error
            assert condition > 1.0 or point.error < 1e-12  # where nothing is skewed it stays small
    assert found >= 7


@pytest.mark.parametrize("beside", [3e-3, pytest.param(1e-5, marks=pytest.mark.long), -1e-4])
@pytest.mark.seldom
def test_two_crossings_as_one_are_seen_wherever_a_row_falls(beside):
    """A row near them has a small value of the test, but that is no measure of how far the test falls."""
    for size, condition in ((1, 1.0), (2, 2e3)):
        generator = np.random.default_rng(3)
        apart = crossings(generator, 0.05, 2, size, condition).follow()
        row = float(np.asarray(apart.columns["p"])[np.argmin(np.abs(np.asarray(apart.columns["p"])))])
        equation = f"(-X*(X - 5*(p - ({row + beside!r}))*(p - ({row + beside + 1e-12!r}))))"
        equations, start = mixed(generator, equation, 0.0, condition, size)
        branch = Planted("together", equations, start, []).follow()
        assert branch.points or branch.notes
        for point in branch.points:
            assert abs(point.values["p"] - row - beside) <= point.error + 1e-12


@pytest.mark.parametrize(
    ("seed", "low", "high"),
    [
        (9056, -12, -8), pytest.param(9092, -12, -8, marks=pytest.mark.long),
        pytest.param(11106, -8, -2, marks=pytest.mark.long), (13047, -8, -2),
    ],
)  # fmt: skip
def test_pairs_that_the_rounding_of_the_jacobian_hides_are_noted(seed, low, high):
    """In skewed coordinates neighbouring points err alike: the test has a minimum above zero, of up to 1e-6."""
    generator = np.random.default_rng(seed)
    spacing, count = 10.0 ** generator.uniform(low, high), int(generator.integers(1, 4))
    size = int(generator.integers(2, 5))
    branch = crossings(generator, spacing, count, size, 10.0 ** generator.uniform(3.5, 5.0)).follow()
    assert branch.points or branch.notes


@pytest.mark.parametrize("seed", [11027, 11050])
def test_a_degenerate_point_between_two_crossings_is_not_stated_better_than_they_are_told_apart(seed):
    generator = np.random.default_rng(seed)
    spacing, count = 10.0 ** generator.uniform(-8, -2), int(generator.integers(1, 4))
    size = int(generator.integers(2, 5))
    planted = crossings(generator, spacing, count, size, 10.0 ** generator.uniform(3.5, 5.0))
    branch = planted.follow()
    assert branch.points or branch.notes
    for point in branch.points:
        assert min(abs(point.values["p"] - expected.at) for expected in planted.expected) <= point.error
