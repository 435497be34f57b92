"""Figures: what is drawn is what the series say; nothing is told by colour alone; no global state."""

import struct
import sys

import numpy as np
import pytest
from matplotlib.text import Text

from contin.errors import InputError
from contin.plot.figure import figure, image_names
from contin.plot.series import from_branches, panels
from contin.plot.strokes import STABLE, UNSTABLE
from contin.plot.write import picture, write_picture
from contin.special.table import table
from contin.store.json_format import result_document
from tests.plot.sample import bautin, branch, hysteresis, pitchfork, special


def document(branches):
    return result_document({"name": "m", "states": ["x"], "parameters": {}}, branches, timing={"total": 1.0})


def drawn(branches, **options):
    sources = from_branches(branches)
    drawing = figure(panels(sources, **options), images=image_names(sources))
    drawing.draw_without_rendering()  # labels find their places when they are drawn
    return drawing


def written(axes):
    return [text for text in axes.texts if text.get_visible()]


def test_stable_parts_are_solid_and_unstable_ones_dashed():
    [axes] = drawn(hysteresis()).axes
    lines = [line for line in axes.get_lines() if len(line.get_xdata()) > 1]
    middle = [line for line in lines if np.all(np.abs(line.get_ydata()) <= 1)]
    assert [line.is_dashed() for line in middle] == [True]
    assert len(lines) == 3
    assert all(not line.is_dashed() for line in lines if line not in middle)
    assert STABLE["linewidth"] > UNSTABLE["linewidth"]


def test_every_type_that_can_share_a_panel_has_its_own_shape():
    groups = (
        "LP BP HB PD NS UZ HOM LPC BPC".split(),
        "CP BT GH ZH HH DP R1 R2 R3 R4".split(),
        "CPC CH GPD LPPD LPNS PDNS NSNS R1 R2 R3 R4".split(),
    )
    for codes in groups:
        assert len({table()[code].marker for code in codes}) == len(codes)


def test_an_image_has_the_colour_of_its_original_and_no_entry_of_its_own():
    drawing = drawn(pitchfork())
    colours = {line.get_color() for line in drawing.axes[0].get_lines() if len(line.get_xdata()) > 1}
    assert len(colours) == 2
    texts = [text.get_text() for text in drawing.legends[0].get_texts()]
    assert texts == ["line (equilibria)", "fork (equilibria)", "stable", "unstable", "BP  branch point"]


def test_labels_are_written_beside_their_points_inside_the_axes():
    [axes] = drawn(hysteresis()).axes
    assert sorted(text.get_text() for text in written(axes)) == ["LP1", "LP2"]
    box = axes.get_window_extent()
    for text in written(axes):
        assert box.contains(*axes.transData.transform(text.xyann))


def test_points_of_one_type_in_one_place_share_a_label():
    p = np.linspace(0, 1, 50)
    near = [special("LP", f"LP{k + 1}", 20 + k, {}) for k in range(5)]
    x = np.where(abs(np.arange(50) - 22) <= 2, 0.5, p)
    made = branch("b", {"p": np.where(abs(np.arange(50) - 22) <= 2, 0.5, p), "x": x, "stable": p > 0.5}, near)
    [axes] = drawn([made]).axes
    assert [text.get_text() for text in written(axes)] == ["LP1-5"]


def test_an_angle_has_ticks_in_multiples_of_pi():
    angle = np.linspace(0, 7, 50)
    made = branch("b", {"p": angle, "psi": angle, "stable": np.ones(50, bool)})
    periods = {"psi": 2 * np.pi}
    drawing = figure(panels(from_branches([made]), periods=periods), periods=periods)
    assert [label.get_text() for label in drawing.axes[0].get_yticklabels()][-1] == "\u03c0"


def test_rounding_noise_of_a_constant_state_is_drawn_flat_and_a_varying_state_is_chosen_first():
    p = np.linspace(0, 4, 30)
    noise = 1 + 2e-16 * np.round(3 * np.sin(40 * p))
    made = branch("b", {"p": p, "x": noise, "y": p**2, "stable": p < 2})
    assert drawn([made]).axes[0].get_ylabel() == "y"
    low, high = drawn([made], y="x").axes[0].get_ylim()
    assert (low, high) == pytest.approx((0.5, 1.5), abs=1e-6)


@pytest.mark.seldom
def test_a_hundred_points_and_twenty_branches_can_be_drawn():
    p = np.linspace(0, 1, 100)
    many = [
        branch(
            f"b{k}",
            {"p": p, "x": np.sin(9 * p + k), "stable": p > 0.5},
            [special("HB", f"HB{i + 1}", 20 * i, {}) for i in range(5)],
        )
        for k in range(20)
    ]
    drawing = drawn(many)
    boxes = [Text.get_window_extent(text) for text in written(drawing.axes[0])]  # without the lines that lead to points
    assert len(boxes) > 40  # as many labels as find room,
    inner = [box.shrunk_to_aspect(1.0).padded(-1) for box in boxes]
    assert not any(a.overlaps(b) for i, a in enumerate(inner) for b in inner[:i])  # and none on another
    assert len(drawing.legends[0].get_texts()) == 3  # stable, unstable, HB: twenty names would bury the picture


@pytest.mark.parametrize(("suffix", "start"), [(".png", b"\x89PNG"), (".pdf", b"%PDF"), (".svg", b"<?xml")])
@pytest.mark.seldom
def test_pictures_of_every_kind_without_pyplot(suffix, start):
    before = "matplotlib.pyplot" in sys.modules
    data = picture(document(bautin()), suffix)
    assert data.startswith(start)
    assert ("matplotlib.pyplot" in sys.modules) == before


def test_a_picture_is_large_enough_for_print(tmp_path):
    write_picture(document(bautin()), tmp_path / "b.png")
    width, height = struct.unpack(">II", (tmp_path / "b.png").read_bytes()[16:24])
    assert width >= 1500
    assert height >= 700


def test_pictures_of_nothing_or_of_an_unknown_kind_are_refused():
    with pytest.raises(InputError, match="no branch"):
        picture(document([]), ".png")
    with pytest.raises(InputError, match=r"\.png, \.pdf, \.svg, \.html"):
        picture(document(bautin()), ".gif")
