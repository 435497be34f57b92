"""The page of results in a real browser, at the sizes of a phone and of a desk: what is shown, clicked and saved."""

import csv
import io

import numpy as np
import pytest

import contin
from contin.plot.html import html_page
from contin.plot.series import from_branches
from tests.browser import DESKTOP, PHONE, browser, opened, sound
from tests.plot.sample import branch, special

HOPF = contin.Model(  # r' = r (mu + r^2 - r^4), phi' = 1: cycles r^2 = (1 +- sqrt(1 + 4 mu))/2 fold at mu = -1/4
    name="bautin", states={"x": 0.0, "y": 0.0}, parameters={"mu": -0.5},
    equations={"x": "x*(mu + x^2 + y^2 - (x^2 + y^2)^2) - y", "y": "y*(mu + x^2 + y^2 - (x^2 + y^2)^2) + x"},
)  # fmt: skip
CLICK = """const [name, row] = arguments;
const found = hoverable.find(h => h.mark && h.mark.label === name)
  || hoverable.find(h => h.branch.name === name && h.row === row);
const box = svg.getBoundingClientRect();
const at = { clientX: box.left + found.x, clientY: box.top + found.y, pointerId: 1, bubbles: true };
svg.setPointerCapture = () => {};
svg.dispatchEvent(new PointerEvent("pointermove", at));
const words = tip.textContent;
svg.dispatchEvent(new PointerEvent("pointerdown", at)); svg.dispatchEvent(new PointerEvent("pointerup", at));
return words;"""


@pytest.fixture(scope="module")
def window():
    with browser() as one:
        yield one


@pytest.fixture(scope="module")
def explored(tmp_path_factory, window):
    page = tmp_path_factory.mktemp("page") / "bautin.html"
    diagram = contin.diagram(HOPF, "mu", (-0.5, 0.3))
    diagram.to_html(page)
    return diagram, page


def count(window, selector):
    return window.execute_script("return document.querySelectorAll(arguments[0]).length", selector)


@pytest.mark.parametrize("size", [PHONE, DESKTOP])
def test_pointing_and_clicking_tell_all_of_a_label(window, explored, size):
    diagram, page = explored
    opened(window, page, size)
    words = window.execute_script(CLICK, "LPC1").split("\n")
    assert words[0].startswith("LPC1: fold of cycles")
    family = next(b for b in diagram.branches if b.kind == "orbit")
    said = dict(line.split(" = ", 1) for line in words[2:])
    assert float(said["mu"]) == pytest.approx(-0.25, abs=1e-7)
    assert set(family.columns) - {"stable", "unstable"} <= set(said)
    assert "b" in said  # the coefficient of its normal form
    assert count(window, "#detail .orbit") == 3  # both states in time, and the closed curve
    assert count(window, "#detail .eigenvalue") == 2
    assert "normal form" in window.execute_script("return document.getElementById('detail').textContent")
    sound(window)
    row = int(np.argmax(np.abs(family.columns["mu"] - 0.15) < 0.02))  # far from every label
    window.execute_script(CLICK, family.name, row)
    assert family.name + ", row" in window.execute_script("return document.querySelector('#detail h2').textContent")
    assert count(window, "#detail .eigenvalue") == 2


def test_orbits_have_filled_circles_where_they_are_stable_and_open_ones_elsewhere(window, explored):
    opened(window, explored[1], DESKTOP)
    assert count(window, ".bead.filled") > 3
    assert count(window, ".bead.open") > 3


@pytest.mark.parametrize("size", [PHONE, DESKTOP])
def test_logarithmic_axes_show_powers_as_lines(window, tmp_path, size):
    p = np.logspace(-3, 3, 61)
    write = html_page(from_branches([branch("power", {"p": p, "x": p**2, "stable": p > 0})]), title="power")
    (tmp_path / "p.html").write_text(write)
    opened(window, tmp_path / "p.html", size)
    for axis in "xy":
        window.execute_script("document.getElementById('log-' + arguments[0]).click()", axis)
    spots = np.array(window.execute_script("return hoverable.map(h => [h.x, h.y])"))
    assert len(spots) == 61
    np.testing.assert_allclose(np.diff(spots, 2, axis=0), 0.0, atol=1e-3)
    ticks = window.execute_script("return [...svg.querySelectorAll('.tick')].map(t => t.textContent)")
    assert "100" in ticks
    window.execute_script("document.getElementById('log-x').click()")
    sound(window)


def test_cycles_of_maps_have_all_their_iterates(window, tmp_path):
    """A cycle of period 64, more columns than a branch has by default."""
    p = np.linspace(0.1, 1.0, 10)
    iterates = {f"x.{k}": np.sqrt(p) + k for k in range(1, 65)}
    fork = branch("fork", {"p": p, "x": np.sqrt(p) + 1, **iterates}, kind="fixed-point")
    (tmp_path / "m.html").write_text(html_page(from_branches([fork]), title="m", x="p", y="x"))
    opened(window, tmp_path / "m.html", DESKTOP)
    assert window.execute_script("return hoverable.length") == 640
    options = window.execute_script("return [...document.querySelectorAll('#bar select')[1].options].map(o => o.value)")
    assert options == ["p", "x"]


def phase_page(path):
    """A square cut by x = 0, of which a part is neutral saddles, with a special point on it."""
    q = np.linspace(-1, 1, 21)
    curve = branch(
        "HB-1", {"p": 0 * q, "q": q, "neutral": q < 0}, [special("BT", "BT1", 10, {"p": 0.0, "q": 0.0}, [0, 0], a=1.0)],
        kind="locus", locus="HB", parameters=("p", "q"),
    )  # fmt: skip
    left, right = ([[x, -1], [x + 1, -1], [x + 1, 1], [x, 1]] for x in (-1, 0))
    regions = [
        {"name": "A", "words": "1 stable <equilibrium>", "stable": 1, "outline": left, "holes": [], "area": 0.5},
        {"name": "B", "words": "none", "stable": 0, "outline": right, "holes": [], "area": 0.5},
    ]
    phase = {"parameters": ["p", "q"], "range": {"p": [-1, 1], "q": [-1, 1]}, "regions": regions, "curves": ["HB-1"]}
    path.write_text(html_page(from_branches([curve]), title="phase", phase=phase))


@pytest.mark.parametrize("size", [PHONE, DESKTOP])
def test_regions_are_shaded_named_and_explained_and_neutral_saddles_are_apart(window, tmp_path, size):
    phase_page(tmp_path / "p.html")
    opened(window, tmp_path / "p.html", size)
    assert count(window, ".region") == 2
    letters = window.execute_script("return [...document.querySelectorAll('.letter')].map(t => t.textContent)")
    assert sorted(letters) == ["A", "B"]
    assert "1 stable <equilibrium>" in window.execute_script("return document.getElementById('key').textContent")
    styles = window.execute_script("return [...svg.querySelectorAll('path[data-style]')].map(p => p.dataset.style)")
    assert sorted(styles) == ["neutral", "plain"]
    assert "neutral saddles" in window.execute_script(CLICK, "HB-1", 3)
    assert "neutral" not in window.execute_script(CLICK, "HB-1", 15)


def test_pictures_and_the_table_are_saved(window, explored):
    diagram, page = explored
    opened(window, page, DESKTOP)
    picture = window.execute_script("return standalone()")
    assert "var(" not in picture
    assert picture.startswith("<svg")
    rows = list(csv.DictReader(io.StringIO(window.execute_script("return table()"))))
    assert len(rows) == sum(len(b) for b in diagram.branches)
    line = diagram.branches[0]
    mine = [float(row["mu"]) for row in rows if row["branch"] == line.name]
    np.testing.assert_allclose(mine, line.columns["mu"], rtol=1e-7)
    assert {row["label"] for row in rows} >= {"HB1", "LPC1"}
    kept = """const done = arguments[0], made = [];
    hand = (blob, ending) => { made.push([ending, blob.type, blob.size]); if (made.length === 3) done(made); };
    for (const kind of ["svg", "csv", "png"]) document.getElementById("save-" + kind).click();"""
    saved = {ending: (kind, size) for ending, kind, size in window.execute_async_script(kept)}
    assert saved["png"][0] == "image/png"
    assert min(size for _, size in saved.values()) > 1000
    sound(window)
