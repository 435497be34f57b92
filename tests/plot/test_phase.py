"""Pictures of phase diagrams: what explains the curves is on the picture, however many types there are."""

import numpy as np
import pytest

from contin.plot.phase import draw

LOCI = ("NS", "HB", "BP", "LPC", "LP", "PD", "BPC", "HOM")
POINTS = ("ZH", "GH", "BT", "CPC", "R1", "DP", "R2", "CP", "NCH", "LPPD")


@pytest.mark.parametrize("count", [1, 4, 8])
def test_explanations_stay_on_the_picture_and_do_not_meet(count):
    t = np.linspace(0.0, 1.0, 9)
    branches = [
        {
            "name": code, "locus": code,
            "columns": {"p": list(t), "q": list(t * (k + 1) / 9), "neutral": [code == "HB"] * 4 + [False] * 5},
            "points": [{"type": POINTS[j], "values": {"p": t[4], "q": (k + 1) / 20}} for j in range(k, k + 3)],
        }
        for k, code in enumerate(LOCI[:count])
    ]  # fmt: skip
    square = {
        "name": "A", "number": 0, "words": "2 of 6 equilibria stable, 1 stable orbit", "area": 1.0, "holes": [],
        "outline": [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]], "stable": 2, "stable_orbits": 1,
    }  # fmt: skip
    box = {"p": [0.0, 1.0], "q": [0.0, 1.0]}
    figure = draw({"curves": LOCI, "parameters": ["p", "q"], "range": box, "regions": [square]}, branches)
    assert len(figure.legends) == 2
    texts = [text for legend in figure.legends for text in legend.get_texts()]
    assert len(texts) >= count + min(count + 2, len(POINTS)) + 1
    places = [text.get_window_extent() for text in texts]
    for one in (*places, *(legend.get_window_extent() for legend in figure.legends)):
        assert 0.0 <= one.x0 < one.x1 <= figure.bbox.width
        assert 0.0 <= one.y0 < one.y1 <= figure.bbox.height
    assert not any(one.overlaps(other) for k, one in enumerate(places) for other in places[:k])


@pytest.mark.parametrize("words", [2, 30])
def test_a_long_title_leaves_room_for_what_explains_the_letters(words):
    square = {
        "name": "A", "number": 0, "words": "2 of 6 equilibria stable, 1 stable orbit", "area": 1.0, "holes": [],
        "outline": [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]], "stable": 2, "stable_orbits": 1,
    }  # fmt: skip
    data = {"curves": [], "parameters": ["p", "q"], "range": {"p": [0.0, 1.0], "q": [0.0, 1.0]}, "regions": [square]}
    figure = draw(data, [], title=" ".join(["oscillations"] * words))
    title = figure.axes[0].title.get_window_extent()
    assert 0.0 <= title.x0 < title.x1 <= figure.bbox.width
    assert title.y1 <= figure.bbox.height
    assert figure.legends
    assert not any(title.overlaps(legend.get_window_extent()) for legend in figure.legends)
