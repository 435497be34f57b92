"""No answer depends on the calls before it: the same runs, from the same starts, in any order, to the last bit.

Starts keep their problems, so whatever a run would leave in one is there for the next.
"""

from functools import cache

import numpy as np
import pytest

import contin
from contin.bvp.from_guess import boundary_guess
from contin.model.model import Model
from tests.bvp.test_boundary_value_problems import BRATU
from tests.loci.sparse.test_loci import combustion
from tests.loci.test_gauges import bautin, henon, leaf
from tests.problems.hybrid.test_orbits import FOLD, TABLE
from tests.problems.large_orbits.cycles import planted

FEW = {"steps": 8}


def run(start, *where, **options):
    return lambda **more: contin.continuation(start, *where, **options | more)


def small():
    """Equilibria, orbits, curves of points and of orbits, maps, boundary values, jumps, a large system."""
    brusselator, henon_map = contin.load("classics/brusselator"), contin.equilibrium(henon())
    rest = contin.equilibrium(brusselator, parameters={"B": 1.0})
    line = contin.continuation(rest, "B", (1.0, 3.0))
    cycles = contin.continuation(contin.periodic_orbit(bautin()), "b1", (-0.5, 0.2), settings={"stop_at": ("LPC",)})
    table = contin.periodic_orbit(TABLE, {"x": 0.01, "v": 0.5}, {"A": 1.05 * FOLD})
    plane, other = {"A": (0.5, 1.5), "B": (1.0, 3.5)}, {"b1": (-0.5, 0.2), "b2": (0.5, 1.5)}
    return {
        "equilibria": run(rest, "B", (1.0, 3.0)),
        "orbits": run(line["HB1"].switch(), "B", (1.0, 2.5), settings=FEW),
        "shot orbits": run(line["HB1"].switch(), "B", (1.0, 2.5), settings={"method": "shooting", "steps": 4}),
        "Hopf points": run(line["HB1"].locus(), ("A", "B"), plane, settings=FEW),
        "folds of cycles": run(cycles["LPC1"].locus(), ("b1", "b2"), other, settings=FEW),
        "fixed points": run(henon_map, "a", (-0.5, 0.6)),
        "boundary values": run(boundary_guess(Model("bratu", **BRATU)), "lam", (0, 4), direction="up", settings=FEW),
        "orbits with jumps": run(table, "A", (0.02, 0.04), settings={"steps": 3}),
        "large equilibria": run(combustion(60), "lam", (0, 4)),
    }  # fmt: skip


def dear():
    """Connections, curves of large equilibria, families of large orbits and their curves."""
    loops = contin.continuation(contin.equilibrium(leaf()), "m", (-1, 1))["HB1"].switch()
    loop = contin.continuation(loops, "m", (-1, 1))["HOM1"]
    large, plane = contin.continuation(combustion(60), "lam", (0, 6)), {"lam": (0, 9), "e": (0.1, 0.3)}
    rest = contin.continuation(planted(-1.0, 0.0), "mu", (-0.6, 0.1))
    hopf = next(point for point in rest.points if abs(point.values["mu"]) < 1e-6)
    coarse, births = {"intervals": 8, "step": 0.05}, hopf.switch()
    family = contin.continuation(births, "mu", (0, 0.6), settings=coarse | {"stop_at": ("PD",)})
    return {
        "homoclinic orbits": run(loop.locus(), ("m", "a"), {"m": (-1, 1), "a": (-1, 1)}, settings={"steps": 3}),
        "folds of large systems": run(large["LP1"].locus(), ("lam", "e"), plane, settings=FEW),
        "large orbits": run(births, "mu", (0, 0.6), settings=coarse | FEW),
        "doublings of large orbits": run(
            family["PD1"].locus(), ("mu", "a"), {"mu": (0.1, 0.5), "a": (-0.2, 0.2)}, settings={"steps": 2}
        ),
    }  # fmt: skip


@cache
def runs(which):
    return which()


def content(branch):
    """All numbers and words of a branch."""
    points = [
        (p.z.tobytes(), p.tangent.tobytes(), p.eigenvalues.tobytes(), p.label, p.residual, p.error, repr(p.normal_form))
        for p in branch.points
    ]
    columns = [(name, np.asarray(column).tobytes()) for name, column in branch.columns.items()]
    arrays = [array.tobytes() for array in (branch.z, branch.tangents, branch.eigenvalues)]
    return arrays, columns, points, repr(branch.ends), branch.notes, branch.unexplained


@pytest.mark.parametrize("which", [small, pytest.param(dear, marks=pytest.mark.seldom)])
def test_runs_give_the_same_bytes_in_either_order_and_twice_in_succession(which):
    wanted = {name: content(follow()) for name, follow in runs(which).items()}
    for name, follow in reversed(runs(which).items()):
        assert content(follow()) == wanted[name], name
        assert content(follow()) == wanted[name], f"{name}, twice"


@pytest.mark.parametrize("kind", ["Hopf points", "folds of cycles", "fixed points", "orbits with jumps"])
def test_an_arm_is_the_same_whether_the_other_one_was_followed_before_it(kind):
    follow = runs(small)[kind]
    both, arms = follow(), [follow(direction=sense) for sense in ("down", "up")]
    assert 0 < both.start_row < len(both) - 1
    for arm, rows in zip(arms, (slice(both.start_row + 1), slice(both.start_row, None)), strict=True):
        np.testing.assert_array_equal(arm.z, both.z[rows])
        np.testing.assert_array_equal(arm.tangents, both.tangents[rows])
