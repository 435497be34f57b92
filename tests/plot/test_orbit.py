"""The picture of an orbit at a labelled point shows that orbit."""

import numpy as np
import pytest

from contin.errors import InputError
from contin.plot.orbit import orbit_figure, write_orbit

PHASE = np.linspace(0.0, 2.0 * np.pi, 9)
ORBIT = {"t": PHASE.tolist(), "x": np.cos(PHASE).tolist(), "y": np.sin(PHASE).tolist()}
POINTS = [
    {"label": "PD1", "values": {"mu": 0.5, "period": 2.0 * np.pi}, "orbit": ORBIT},
    {"label": "PD2", "values": {"mu": 0.7, "period": 2.0 * np.pi}},
]
DOCUMENT = {
    "model": {"name": "circle", "states": ["x", "y"]},
    "branches": [{"name": "start/HB1", "parameters": ["mu"], "points": POINTS}],
}


def test_time_series_and_phase_portrait_are_those_of_the_point():
    drawing = orbit_figure(DOCUMENT, "start/HB1.PD1", x="y", y="x")
    lines = [line.get_xydata() for ax in drawing.axes for line in ax.get_lines()]
    np.testing.assert_allclose(lines[0], np.stack([ORBIT["t"], ORBIT["x"]], axis=1))
    np.testing.assert_allclose(lines[1], np.stack([ORBIT["t"], ORBIT["y"]], axis=1))
    np.testing.assert_allclose(lines[2], np.stack([ORBIT["y"], ORBIT["x"]], axis=1))
    assert len(lines) == 3  # a closed orbit has no start and no end
    assert "mu = 0.5" in drawing.get_suptitle()


@pytest.mark.parametrize("point", ["start/HB1.PD2", "start/HB1.PD9", "nowhere.PD1", "PD1"])
def test_a_point_without_an_orbit_is_refused_with_those_that_have_one(point):
    with pytest.raises(InputError, match=r"no orbit .*kept at start/HB1\.PD1"):
        orbit_figure(DOCUMENT, point)


def test_pictures_only(tmp_path):
    with pytest.raises(InputError, match="pictures of orbits end in"):
        write_orbit(DOCUMENT, "start/HB1.PD1", tmp_path / "orbit.html", None, None)
    write_orbit(DOCUMENT, "start/HB1.PD1", tmp_path / "orbit.svg", None, None)
    assert b"<svg" in (tmp_path / "orbit.svg").read_bytes()
