"""Several multipliers -1, or pairs on the unit circle, at one place: labels with their number, and every doubled cycle.

Cycles of period two of the logistic map: x + y = 1 + 1/r, x y = (1 + 1/r)/r.
"""

from __future__ import annotations

import numpy as np
import pytest

import contin

CELL = "r*{0}*(1 - {0})"


def logistic_maps(names: str, coupling: float = 0.0) -> contin.Model:
    """Equal cells, coupled all to all: near x = 1 - 1/r modes across the sum have the multiplier 2 - r - n e."""
    total = " + ".join(names)
    return contin.Model(
        "cells", kind="map", states=dict.fromkeys(names, 0.4), parameters={"r": 2.5, "e": coupling},
        equations={x: f"{CELL.format(x)} + e*({total} - {len(names)}*{x})" for x in names},
    )  # fmt: skip


def doubled(r: float) -> list[float]:
    s = 1 + 1 / r
    return sorted(np.roots([1.0, -s, s / r]).real)


def test_two_maps_alone_double_together_and_every_pair_of_their_cycles_is_a_branch():
    line = contin.continuation(logistic_maps("xu"), "r", (2.5, 3.2))
    point = line["PD1"]
    assert [p.label for p in line.points] == ["PD1"]
    assert abs(point.values["r"] - 3.0) <= point.error
    assert dict(point.normal_form) == {"kernel": 2}
    assert "no normal form" in line.notes[0]
    ends = []
    for start in point.switch():
        branch = contin.continuation(start, "r", (2.5, 3.2), settings={"steps": 60})
        columns = branch.columns
        assert columns["r"][-1] == 3.2
        ends.append([(columns[f"{x}.1"][-1], columns[f"{x}.2"][-1]) for x in "xu"])
    low, high = doubled(3.2)
    rest = 1 - 1 / 3.2
    found = sorted(tuple(float(v) for v in np.sort(pair)) for end in ends for pair in end)
    np.testing.assert_allclose(found, sorted([(low, high)] * 6 + [(rest, rest)] * 2), atol=1e-9)
    products = sorted((x[0] - x[1]) * (u[0] - u[1]) for x, u in ends)  # in phase, opposite, one cell alone twice
    np.testing.assert_allclose(products, np.array([-1, 0, 0, 1]) * (high - low) ** 2, atol=1e-9)


def test_three_coupled_maps_double_in_six_ways_that_only_the_fifth_order_tells_apart():
    """Of D3 x Z2: in three of them two cells are equal, in three they are half a period apart and one has period 1."""
    line = contin.continuation(logistic_maps("xuv", 0.1), "r", (2.5, 3.1))
    pair, single = line.points
    assert (pair.values["r"], pair.vectors["kernel"]) == (pytest.approx(2.7, abs=1e-12), 2)
    assert single.values["r"] == pytest.approx(3.0, abs=1e-12)
    kinds = []
    for start in pair.switch():
        branch = contin.continuation(start, "r", (2.5, 2.75))
        assert branch.columns["r"][-1] == 2.75
        first, second = (np.array([branch.columns[f"{x}.{k}"][-1] for x in "xuv"]) for k in (1, 2))
        standing = np.abs(first - second) < 1e-9
        kinds.append(bool(standing.any()))
        if standing.any():
            np.testing.assert_allclose(np.sort(first), np.sort(second), atol=1e-9)
        else:
            assert min(abs(first[i] - first[j]) for i, j in ((0, 1), (0, 2), (1, 2))) < 1e-9
    assert sorted(kinds) == [False] * 3 + [True] * 3


def test_equal_pairs_of_a_map_are_a_label_with_a_note():
    delayed = {"x": "r*x*(1 - y)", "y": "x", "u": "r*u*(1 - v)", "v": "u"}
    model = contin.Model("two", kind="map", states=dict.fromkeys("xyuv", 0.4), parameters={"r": 1.8}, equations=delayed)
    line = contin.continuation(model, "r", (1.7, 2.2))
    assert [(p.label, dict(p.normal_form)) for p in line.points] == [("NS1", {"kernel": 2})]
    assert len(line.notes) == 1
    assert "several pairs" in line.notes[0]
