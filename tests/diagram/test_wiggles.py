"""Which families are followed beside a homoclinic orbit to a saddle-focus."""

from types import SimpleNamespace

import numpy as np
import pytest

from contin.diagram.wiggles import beside_homoclinic

FOLDS = 12


def family(born_at=(), spiral=True, reverse=False):
    """Folds at (-1/2)^k about the homoclinic value 3, a period of 2 more each; doublings before and after every one."""
    rows = [("PD", 0.0, 5.0), ("PD", 0.5, 6.0)]
    for k in range(FOLDS):
        rows.append(("LPC", 3.0 + (-0.5) ** k, 10.0 + 2.0 * k))
        rows += [("PD", 3.0 + 0.9 * (-0.5) ** k, 10.1 + 2.0 * k), ("PD", 3.0 - 0.4 * (-0.5) ** k, 11.9 + 2.0 * k)]
    rows.append(("HOM", 3.0, 80.0))
    ends = [SimpleNamespace(data={}), SimpleNamespace(data={"at": {"p": 3.0}, "spiral": spiral})]
    if reverse:
        rows, ends = rows[::-1], ends[::-1]
    points = [
        SimpleNamespace(type=type_, label=f"{type_}{k}", index=k, values={"p": p, "period": period})
        for k, (type_, p, period) in enumerate(rows)
    ]
    columns = {name: np.array([point.values[name] for point in points]) for name in ("p", "period")}
    return SimpleNamespace(points=points, ends=ends, columns=columns, parameters=("p",), born_at=born_at)


def followed(branch):
    """Periods of the doublings that are followed."""
    doublings = (point for point in branch.points if point.type == "PD")
    return sorted(point.values["period"] for point in doublings if not beside_homoclinic(branch, point))


@pytest.mark.parametrize("reverse", [False, True])
def test_doublings_before_the_folds_and_the_pair_between_the_first_two_are_followed(reverse):
    assert followed(family(reverse=reverse)) == [5.0, 6.0, 10.1, 11.9]


def test_of_doubled_families_none_are_followed():
    assert followed(family(born_at=("HB", "PD"))) == []


def test_elsewhere_all_are_followed():
    assert len(followed(family(spiral=False))) == 2 * FOLDS + 2
