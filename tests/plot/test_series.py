"""Plot series: portions by stability, breaks at angle wraps, marks on rows; the same from memory and from a file."""

import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from contin.errors import InputError
from contin.plot.labels import densify, place
from contin.plot.series import Source, from_branches, from_document, panels
from contin.store.json_format import dumps, result_document
from tests.plot.sample import bautin, branch, hysteresis, pitchfork, special


def portions(panel, name):
    return [portion for curve in panel.curves if curve.name == name for portion in curve.portions]


def test_an_s_of_equilibria_is_stable_unstable_stable_and_joins_at_its_folds():
    [panel] = panels(from_branches(hysteresis()))
    low, middle, high = portions(panel, "states")
    assert [portion.stable for portion in (low, middle, high)] == [True, False, True]
    assert low.y[-1] == middle.y[0] == -1.0
    assert middle.y[-1] == high.y[0] == 1.0
    assert [(x, y) for x, y, _ in panel.curves[0].marks] == [(2.0, -1.0), (-2.0, 1.0)]


@given(flags=st.lists(st.booleans(), min_size=2, max_size=40), labelled=st.data())
def test_pieces_cover_every_segment_exactly_once(flags, labelled):
    rows = len(flags)
    marks = labelled.draw(st.sets(st.integers(0, rows - 1)))
    points = [special("LP", f"LP{k}", row, {}) for k, row in enumerate(sorted(marks))]
    p = np.arange(rows, dtype=float)
    made = branch("b", {"p": p, "x": p**2, "stable": flags}, points)
    [panel] = panels(from_branches([made]))
    segments = [(i, i + 1) for portion in panel.curves[0].portions for i in portion.rows[:-1]]
    assert segments == [(i, i + 1) for i in range(rows - 1)]


def test_an_angle_that_turns_is_broken_where_it_wraps():
    angle = np.linspace(0.0, 6 * np.pi, 301)
    made = branch("b", {"p": angle, "psi": angle, "stable": np.ones(301, bool)})
    [panel] = panels(from_branches([made]), y="psi", periods={"psi": 2 * np.pi})
    turns = panel.curves[0].portions
    assert len(turns) == 4  # from 0 to pi, two full turns, and from -pi to 0
    for portion in turns:
        assert np.all(np.diff(portion.y) > 0)
        assert np.all(np.abs(portion.y) <= np.pi + 1e-12)


def test_an_angle_that_stays_at_half_a_turn_does_not_flicker():
    noise = np.pi + 1e-15 * (-1.0) ** np.arange(20)
    made = branch("b", {"p": np.arange(20.0), "psi": noise, "stable": np.ones(20, bool)})
    [panel] = panels(from_branches([made]), y="psi", periods={"psi": 2 * np.pi})
    [portion] = panel.curves[0].portions
    np.testing.assert_allclose(portion.y, np.pi)


def test_a_gap_in_the_numbers_is_a_gap_in_the_curve():
    y = np.array([0.0, 1.0, np.nan, 3.0, 4.0])
    [panel] = panels(from_branches([branch("b", {"p": np.arange(5.0), "x": y, "stable": np.ones(5, bool)})]))
    assert [list(portion.rows) for portion in panel.curves[0].portions] == [[0, 1], [3, 4]]


def test_orbits_have_a_strand_of_maxima_and_one_of_minima_and_loci_a_panel_of_their_own():
    diagram, plane = panels(from_branches(bautin()), units={"p": "1/s"})
    strands = portions(diagram, "cycles")
    assert max(portion.y.max() for portion in strands) == -min(portion.y.min() for portion in strands)
    assert (diagram.x_label, plane.x, plane.y) == ("p (1/s)", "p", "q")
    assert [portion.stable for portion in portions(plane, "folds")] == [None]


def test_axes_can_be_chosen_and_an_absent_column_names_those_there_are():
    [panel] = panels(from_branches(bautin()), y="period")
    assert [curve.name for curve in panel.curves] == ["cycles"]
    with pytest.raises(InputError, match=r"y = z; columns: p, period, q, stable, unstable, x, y"):
        panels(from_branches(bautin()), y="z")


def test_several_columns_give_a_panel_each():
    made = panels(from_branches(bautin()[:2]), y=["x", "y"])
    assert [(panel.x, panel.y) for panel in made] == [("p", "x"), ("p", "y")]


def test_a_file_gives_the_same_series_as_memory():
    branches = [*pitchfork(), *hysteresis(), *bautin()]
    model = {"name": "m", "states": ["x"], "parameters": {}}
    document = json.loads(dumps(result_document(model, branches, timing={"total": 1.0})))
    here, there = panels(from_branches(branches)), panels(from_document(document))
    assert sum(len(panel.curves) for panel in here) >= len(branches)
    for a, b in zip(here, there, strict=True):
        assert (a.x, a.y, [c.name for c in a.curves]) == (b.x, b.y, [c.name for c in b.curves])
        for one, two in zip(a.curves, b.curves, strict=True):
            assert [p.stable for p in one.portions] == [p.stable for p in two.portions]
            for p, q in zip(one.portions, two.portions, strict=True):
                np.testing.assert_array_equal(p.y, q.y)
            assert [m.label for *_, m in one.marks] == [m.label for *_, m in two.marks]


def test_a_document_that_is_damaged_is_refused():
    model = {"name": "m", "states": ["x"], "parameters": {}}
    document = result_document(model, pitchfork(), timing={"total": 1.0})
    document["branches"][0]["points"][0]["index"] = 10_000
    with pytest.raises(InputError, match="outside its rows"):
        from_document(document)
    with pytest.raises(InputError, match="not a contin result"):
        from_document({"branches": [{"name": "b"}]})


@given(
    anchors=st.lists(st.tuples(st.integers(0, 900), st.integers(0, 600)), min_size=1, max_size=6, unique=True),
    seed=st.integers(0, 9),
)
def test_labels_of_a_few_points_never_overlap_and_stay_in_the_frame(anchors, seed):
    at = np.array(anchors, float)
    sizes = np.full((len(at), 2), (40.0, 12.0))
    curve = np.random.default_rng(seed).uniform(0, 900, (30, 2))
    centres = place(at, sizes, curve, (0.0, 0.0, 900.0, 600.0))
    assert np.all(centres - sizes / 2 >= 0)
    assert np.all(centres + sizes / 2 <= [900, 600])
    for i in range(len(at)):
        for j in range(i):
            assert np.any(np.abs(centres[i] - centres[j]) >= (sizes[i] + sizes[j]) / 2)


def test_a_label_avoids_the_curve_beside_its_point():
    curve = densify([np.array([[0.0, 300.0], [900.0, 300.0]])], 2.0)
    [centre] = place(np.array([[450.0, 300.0]]), np.array([[40.0, 12.0]]), curve, (0.0, 0.0, 900.0, 600.0))
    assert abs(centre[1] - 300.0) > 6.0


def test_responses_to_a_forcing_are_drawn_by_their_states_not_by_the_period_that_is_given():
    omega = np.linspace(1.0, 2.0, 5)
    columns = {"omega": omega, "period": 2 * np.pi / omega, "x.min": -omega, "x.max": omega, "stable": omega > 0}
    (panel,) = panels([Source("response", "orbit", None, ("omega",), columns, ())])
    assert panel.y == "x"
    flat = columns | {"x.min": 0 * omega, "x.max": 0 * omega}
    (panel,) = panels([Source("rest", "orbit", None, ("omega",), flat, ())])
    assert panel.y == "period"
