"""Notes on branches of cycles of maps say only what is so."""

import contin
from contin.model.model import Model


def test_a_neutral_saddle_of_a_smooth_map_is_no_corner():
    """Predator and prey: on u2 = 0 the doubled cycle has two real multipliers whose product passes 1."""
    model = Model(
        "prey", kind="map", states={"u1": 0.5, "u2": 0.0}, parameters={"p1": 2.0, "p2": 0.2, "p3": 0.1},
        equations={"u1": "p1*u1*(1 - u1) - p2*u1*u2", "u2": "(1 - p3)*u2 + p2*u1*u2"},
    )  # fmt: skip
    line = contin.continuation(contin.equilibrium(model, {"u1": 0.5, "u2": 0.0}), "p1", (1.5, 4.0))
    two = contin.continuation(line["PD1"].switch(), "p1", (1.5, 4.0))
    assert [point.type for point in two.points] == ["PD"]
    assert two.notes == ()
