"""Families and curves in two parameters of random systems, followed by default and in short steps: the same of both."""

import numpy as np
import pytest

import contin
from contin.errors import NoSolutionError, NotFiniteError
from tests.truth import random_dynamics

SHORT = {"max_step": 0.02, "steps": 2000}
FOLLOWED = ("LP", "LPC", "PD", "NS", "BP", "BPC")
BEARING = ("HB", "PD", "BP", "BPC")
SAFETY = 3.0  # of errors, which are estimates
DIGITS = 1e-8  # of a place, and of a coefficient, that no error estimate is asked for
CREEPING = 500  # rows of a branch that is followed by default
ALIKE = 1e-5  # of a range: points nearer than this are one


def both_ways(start, names, box):
    """Followed by default and in short steps; None where there is no start."""
    ranges = box[names] if isinstance(names, str) else {name: box[name] for name in names}
    try:
        return [contin.continuation(start(), names, ranges, settings=settings) for settings in ({}, SHORT)]
    except (NoSolutionError, NotFiniteError):
        return None


def place(point, names, box):
    return np.array([point.values[n] / np.ptp(box[n]) for n in names])


def point_has_no_sense(point, name):
    """Of a fold of forced orbits the null function, and so b, is known up to its sign."""
    return point.type == "LPC" and name == "b"


def coefficients_differ(one, other):
    for name, value in one.normal_form.items():
        counterpart = other.normal_form.get(name)
        if isinstance(value, float) and isinstance(counterpart, float):
            errors = sum(point.normal_form.get("errors", {}).get(name, 0.0) for point in (one, other))
            if point_has_no_sense(one, name):
                value, counterpart = abs(value), abs(counterpart)
            if abs(value - counterpart) > SAFETY * errors + DIGITS * abs(value):
                yield f"{one.label}: {name} {value!r} and {counterpart!r}, errors {errors:.1e}"
        elif isinstance(value, str) and value != counterpart and "degenerate" not in (value, counterpart):
            yield f"{one.label}: {name} {value} and {counterpart}"


def complaints(coarse, fine, names, box):
    """What one of two branches has and the other has not; notes say that something is not known."""
    names = (names,) if isinstance(names, str) else names
    for one, other, said in ((coarse, fine, "by default"), (fine, coarse, "in short steps")):
        for point in (p for p in one.points if p.type != "DP"):  # at GPD, where curves of folds end
            alike = [p for p in other.points if p.type == point.type]
            apart = [np.abs(place(p, names, box) - place(point, names, box)).max() for p in alike]
            if not apart or min(apart) > ALIKE:
                if not (coarse.notes or fine.notes):
                    yield f"{point.label} at {[point.values[n] for n in names]} only {said}"
            elif one is coarse:
                nearest = alike[int(np.argmin(apart))]
                stated = SAFETY * (point.error + nearest.error) + DIGITS * abs(point.values[names[0]])
                if abs(point.values[names[0]] - nearest.values[names[0]]) > stated:
                    yield f"{point.label}: {point.values[names[0]]!r} and {nearest.values[names[0]]!r}, {stated:.1e}"
                yield from coefficients_differ(point, nearest)
    if len(coarse) > CREEPING:
        yield f"{len(coarse)} rows"
    reasons = [{end.reason for end in branch.ends} for branch in (coarse, fine)]
    if reasons[0] != reasons[1] and not any({"steps", "corrector"} & found for found in reasons):
        yield f"ends {reasons[0]} and {reasons[1]}"
    changes = [np.count_nonzero(np.diff(np.asarray(b.columns["unstable"], float))) for b in (coarse, fine)]
    if changes[0] != changes[1] and not (coarse.notes or fine.notes):
        yield f"unstable changes {changes[0]} and {changes[1]} times"


def of_curves(branch, box, limit):
    """Complaints of the curves in two parameters through the first points of a family."""
    names = tuple(box)
    for point in [p for p in branch.points if p.type in FOLLOWED][:limit]:
        found = both_ways(point.locus, names, box)
        texts = ["it has no start"] if found is None else complaints(*found, names, box)
        yield from (f"curve of {point.label}: {text}" for text in texts)


def found_in(kind, seed, limit=2):
    """Complaints of a random system: of its fixed points or orbits, of what is born on them, of curves of either."""
    model, box = getattr(random_dynamics, kind)(seed)
    name = next(iter(box))
    try:
        start = contin.periodic_orbit(model) if kind == "forced" else contin.equilibrium(model)
    except (NoSolutionError, NotFiniteError):
        return []
    begun = both_ways(lambda: start, name, box)
    found = list(complaints(*begun, name, box))
    if kind in ("forced", "quadratic_map"):
        found += of_curves(begun[0], box, limit)
    for point in [p for p in begun[0].points if p.type in BEARING][:limit]:
        family = both_ways(point.switch, name, box)
        texts = ["nothing is born there"] if family is None else [*complaints(*family, name, box)]
        texts += [] if family is None else of_curves(family[0], box, limit)
        found += [f"from {point.label}: {text}" for text in texts]
    return found


@pytest.mark.parametrize(
    ("kind", "seed"), [("forced", 9), ("forced", 11), ("quadratic_map", 3), ("quadratic_map", 14)],
)  # fmt: skip
def test_what_is_found_does_not_depend_on_the_steps(kind, seed):
    assert found_in(kind, seed) == []


@pytest.mark.long
@pytest.mark.parametrize("kind", ["forced", "quadratic_map", "pair", "bursting", "turbulence"])
def test_what_is_found_does_not_depend_on_the_steps_in_many_systems(kind):
    found = {seed: found_in(kind, seed, 4) for seed in range(100, 120)}
    assert not any(found.values()), {seed: texts for seed, texts in found.items() if texts}
