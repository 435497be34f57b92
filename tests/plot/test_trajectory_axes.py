"""Which columns a portrait shows."""

import numpy as np

from contin.plot.look import Look
from contin.plot.trajectory import figure

COLUMNS = {name: np.linspace(0.0, 1.0, 5) for name in ("t", "a", "b", "c")}


def axes_of(**look):
    portrait = figure(COLUMNS, ["a", "b", "c"], look=Look.of(look)).axes[-1]
    return portrait.get_xlabel(), portrait.get_ylabel()


def test_no_column_is_drawn_over_itself_unless_that_is_asked_for():
    assert axes_of() == ("a", "b")
    assert axes_of(y="a") == ("b", "a")
    assert axes_of(y="c") == ("a", "c")
    assert axes_of(x="b") == ("b", "a")
    assert axes_of(y=["b", "a"]) == ("b", "a")
    assert axes_of(x="c", y=["b", "a"]) == ("c", "b")
    assert axes_of(x="a", y="a") == ("a", "a")
