"""Pictures look as those that were looked at: small references, and a bound that a lost curve or label exceeds.

After a change that is meant, look at the new pictures (a failing test leaves them in pytest's folder), and put them
into `tests/plot/reference`.
"""

import shutil
from pathlib import Path

import numpy as np
import pytest
from cycler import cycler
from matplotlib import rc_context
from matplotlib.figure import Figure
from matplotlib.testing.compare import compare_images

import contin
from contin.errors import InputError

FOLDER = Path(__file__).parent / "reference"
TOLERANCE = 9.0  # root mean square of grey values; fonts and antialiasing of other versions make 2 to 6
SMALL = {"size": (4.0, 3.2), "style": {"figure.dpi": 72.0, "savefig.dpi": 72.0}}


@pytest.fixture(scope="module")
def diagram():
    return contin.diagram(contin.load("brusselator"), "B", (0, 4))


@pytest.fixture(scope="module")
def cusp():
    model = contin.Model(
        "cusp", states={"x": -1.5}, parameters={"a": -1.0, "b": 1.0}, equations={"x": "a + b*x - x^3"}
    )
    line = contin.continuation(contin.equilibrium(model), "a", (-2, 2))
    return contin.continuation(line["LP1"].locus(), ("a", "b"), {"a": (-2, 2), "b": (-1, 2)})


@pytest.fixture(scope="module")
def fork():
    return contin.diagram(contin.load("logistic"), "r", (0.5, 3.5))


@pytest.fixture(scope="module")
def response():
    return contin.diagram(contin.load("classics/duffing"), "omega")


PICTURES = {
    "diagram": lambda r: r("diagram").plot(**SMALL),
    "axes": lambda r: r("diagram").plot(y="y", log=["y"], limits={"B": (1, 4)}, legend="inside", title="t", **SMALL),
    "eigenvalues": lambda r: r("diagram").branches[0].plot(y="eigenvalues", legend=False, **SMALL),
    "orbit": lambda r: r("diagram").branches[-1].orbit(-1).plot(**SMALL),
    "cusp": lambda r: r("cusp").plot(**SMALL),
    "fork": lambda r: r("fork").plot(legend=False, **SMALL),
    "response": lambda r: r("response").plot(**SMALL),
}


@pytest.mark.parametrize("name", PICTURES)
def test_pictures_are_those_that_were_looked_at(name, request, tmp_path):
    drawing = PICTURES[name](request.getfixturevalue)
    drawing.savefig(tmp_path / f"{name}.png", dpi=72)
    shutil.copy(FOLDER / f"{name}.png", tmp_path / "expected.png")
    assert compare_images(str(tmp_path / "expected.png"), str(tmp_path / f"{name}.png"), TOLERANCE) is None


def test_a_lost_branch_exceeds_the_tolerance(diagram, tmp_path):
    diagram.branches[0].plot(**SMALL).savefig(tmp_path / "lost.png", dpi=72)
    shutil.copy(FOLDER / "diagram.png", tmp_path / "expected.png")
    assert compare_images(str(tmp_path / "expected.png"), str(tmp_path / "lost.png"), TOLERANCE) is not None


@pytest.mark.parametrize("name", ["diagram", "cusp", "response"])
def test_a_legend_takes_a_quarter_of_the_height_at_most(name, request):
    drawing = PICTURES[name](request.getfixturevalue)
    drawing.draw_without_rendering()
    assert drawing.legends
    for legend in drawing.legends:
        assert legend.get_window_extent().height <= 0.26 * drawing.bbox.height


def test_options_of_pictures_hold_for_orbits_and_trajectories_too(diagram):
    orbit = diagram.branches[-1].orbit(-1)
    trajectory = contin.simulate(contin.load("brusselator"), {"x": 2.0, "y": 1.0}, time=5.0)
    for thing in (orbit, trajectory):
        drawn = thing.plot(limits={"x": (0, 5)}, log=["y"], size=(7, 3), title="one", style={"font.size": 6})
        assert tuple(drawn.get_size_inches()) == (7.0, 3.0)
        portrait = drawn.axes[-1]
        assert (portrait.get_xlim(), portrait.get_yscale()) == ((0.0, 5.0), "log")
        ax = Figure().subplots()
        thing.plot(ax=ax, x="y", y="x", title="two")
        assert (ax.get_xlabel(), ax.get_ylabel(), ax.get_title()) == ("y", "x", "two")
        with pytest.raises(InputError, match="no option"):
            thing.plot(colour="red")


def test_eigenvalues_along_a_branch_are_drawn_as_they_are(diagram):
    line = diagram.branches[0]
    ax = Figure().subplots()
    line.plot(ax=ax, y="eigenvalues", labels=False)
    drawn = np.concatenate([curve.get_ydata() for curve in ax.lines if len(curve.get_ydata()) > 2])
    assert drawn.max() == pytest.approx(line.eigenvalues.real.max())
    assert ax.get_ylabel() == "eigenvalues, real parts"


def test_changes_of_rcparams_are_kept(diagram):
    with rc_context({"figure.figsize": (6, 3), "axes.prop_cycle": cycler(color=["purple", "green"])}):
        drawn = diagram.plot()
    assert tuple(drawn.get_size_inches()) == (6.0, 3.0)
    assert {"purple", "green"} <= {line.get_color() for line in drawn.axes[0].lines}
