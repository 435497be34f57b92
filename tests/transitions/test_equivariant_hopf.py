"""Families of cycles at Hopf points of equal cells, all coupled alike: the equivariant Hopf theorem's patterns.

Each simple eigenvalue of a permutation of n cells, without the one of equal cells, gives one. Up to permutations these
are, of three cells, the wave (1, w, w^2) and (1, -1, 0), (1, 1, -2); of four (1, -1, 0, 0), (1, 1, -1, -1),
(1, 1, 1, -3), (1, w, w^2, 0) and the wave (1, i, -1, -i); of five seven.
"""

import numpy as np
import pytest

import contin

DAMPED = 0.7  # equal motions of all cells


def cells(n: int, symmetries: tuple[str, ...] = ("turn", "swap"), mass: bool = False) -> contin.Model:
    """z' = (p + i) z - (1 + .4 i) z |z|^2 + quadratic terms - c sum of z; with `mass` a further algebraic state."""
    states, equations, x, y = {}, {}, [f"x{k}" for k in range(n)], [f"y{k}" for k in range(n)]
    for a, b in zip(x, y, strict=True):
        states |= {a: {"value": 0.0, "scale": 1}, b: {"value": 0.0, "scale": 1}}
        sums = "s" if mass else f"({' + '.join(x)})"
        equations[a] = f"p*{a} - {b} - ({a} - 0.4*{b})*({a}^2 + {b}^2) + .2*{a}^2 + .3*{a}*{b} - {DAMPED}*{sums}"
        equations[b] = f"p*{b} + {a} - ({b} + 0.4*{a})*({a}^2 + {b}^2) - .3*{a}*{b} - {DAMPED}*({' + '.join(y)})"
    moves = {"turn": lambda k: (k + 1) % n, "swap": lambda k: {0: 1, 1: 0}.get(k, k)}
    declared = {s: {f"{v}{k}": f"{v}{moves[s](k)}" for v in "xy" for k in range(n)} for s in symmetries}
    extra = {"mass": {"s": 0}} if mass else {}
    if mass:
        states["s"] = {"value": 0.0, "scale": 1}
        equations["s"] = f"{' + '.join(x)} - s"
    return contin.Model(
        "cells", states=states, parameters={"p": -0.5}, equations=equations, symmetries=declared, **extra
    )


def hopf_point(model: contin.Model):
    line = contin.continuation(contin.equilibrium(model), "p", (-0.5, 0.3))
    assert [p.type for p in line.points] == ["HB"]
    assert line["HB1"].values["p"] == pytest.approx(0.0, abs=1e-12)
    return line


def every(seeds):
    return seeds if isinstance(seeds, (list, tuple)) else [seeds]


@pytest.mark.parametrize(
    ("n", "families", "mass"),
    [
        (3, 3, False),
        (3, 3, True),
        pytest.param(4, 5, False, marks=pytest.mark.seldom),
        pytest.param(5, 7, False, marks=pytest.mark.seldom),
    ],
)
def test_a_family_for_every_pattern(n, families, mass):
    line = hopf_point(cells(n, mass=mass))
    assert line["HB1"].normal_form == {"kernel": n - 1}
    assert not line.notes
    seeds = every(line["HB1"].switch())
    assert len(seeds) == families
    if n > 3:
        return
    patterns = set()
    for seed in seeds:
        branch = contin.continuation(seed, "p", (-0.5, 0.1), settings={"stop_at": ["NS"]})
        assert branch.ends[1].reason == "bound"
        assert not branch.notes
        assert branch.columns["unstable"][0] == 0  # all other eigenvalues are negative
        sizes = np.sort([np.ptp(branch.orbit(-1).columns[f"x{k}"]) for k in range(n)])
        patterns.add(tuple(round(s) for s in 10 * sizes / sizes[-1]))
    assert {(10, 10, 10), (0, 10, 10)} < patterns
    assert len(patterns) == 3


def test_symmetries_that_do_not_make_pairs_cross_together_leave_a_note():
    """Turns alone keep two waves apart: that they cross together is what swaps do."""
    line = hopf_point(cells(3, ("turn",)))
    (note,) = line.notes
    assert "several pairs of eigenvalues cross at once" in note
    assert len(every(line["HB1"].switch())) == 2  # the waves in both senses; they are one up to swaps


@pytest.mark.parametrize("n", [3, 4, 5])
def test_without_symmetries_the_eigenspace_gives_one(n):
    line = hopf_point(cells(n, ()))
    assert len(every(line["HB1"].switch())) == 1
    assert line.notes
