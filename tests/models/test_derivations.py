"""Numbers expected in the bundled models follow from closed forms, in 30 digits and without contin's engine."""

import mpmath
import pytest

import contin
from contin.model.evaluate import evaluate
from tests.models.closed_curves import special_points
from tests.models.curves import CURVES
from tests.models.loaded import load


def cases():
    """Every expectation of folds and Hopf points over one run in the parameter of a known curve."""
    for name, curve in CURVES.items():
        for k, item in enumerate(load(name).expect):
            [run, *more] = item.runs
            start = run.get("start", "prey" if name == "predator-prey" else None)
            known = not more and run["parameter"] == curve.parameter and start in (None, "prey", "inner")
            if known and item.label in ("LP", "HB") and not (name == "predator-prey" and item.label == "HB"):
                yield pytest.param(name, k, id=f"{name}-{item.label}-{k}")


@pytest.mark.parametrize(("name", "k"), list(cases()))
def test_folds_and_hopf_points_are_where_the_determinants_change_sign(name, k):
    model = load(name)
    item = model.expect[k]
    [run] = item.runs
    values = {key: mpmath.mpf(str(evaluate_number(v))) for key, v in run.get("parameters", {}).items()}
    found = special_points(model, CURVES[name], run["range"], **values)[item.label]
    defaults = model.default_parameters(run.get("parameters", {}))
    wanted = [{key: float(evaluate(v, defaults)) for key, v in point.items()} for point in item.at]
    assert len(found) == len(wanted)
    for point in wanted:
        gap = min(max(abs(float(f[key]) - value) for key, value in point.items()) for f in found)
        assert gap < 1e-13 * max(1.0, *map(abs, point.values()))


def evaluate_number(text):
    """A number or a quotient of numbers, such as 1/15, in 30 digits."""
    with mpmath.workdps(30):
        top, _, bottom = str(text).partition("/")
        return mpmath.mpf(top) / mpmath.mpf(bottom or 1)


def test_the_special_points_of_a_known_system_are_found():
    """x' = p - x^2, y' = -y: one fold. x' = p x - y - ..., with trace 2 p: one Hopf point and no fold."""
    from tests.models.closed_curves import Curve

    fold = contin.Model("fold", states={"x": 1, "y": 0}, parameters={"p": 1}, equations={"x": "p - x^2", "y": "-y"})
    curve = Curve("p", -1.3, 1.1, lambda s, c, m: {"x": s, "y": mpmath.mpf(0), "p": s**2})
    found = special_points(fold, curve, (-1, 2))
    assert [float(p["p"]) for p in found["LP"]] == pytest.approx([0], abs=1e-25)
    assert found["HB"] == []  # the trace -2 s - 1 vanishes at a neutral saddle, s = -1/2
    hopf = contin.Model(
        "hopf", states={"x": 0, "y": 0}, parameters={"p": 1}, equations={"x": "p*x - y", "y": "x + p*y"}
    )
    zero = mpmath.mpf(0)
    found = special_points(hopf, Curve("p", -1.3, 1.1, lambda s, c, m: {"x": zero, "y": zero, "p": s}), (-2, 2))
    assert [float(p["p"]) for p in found["HB"]] == pytest.approx([0], abs=1e-25)
    assert found["LP"] == []
