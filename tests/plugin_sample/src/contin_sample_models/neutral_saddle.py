"""A special point that contin does not label by itself: neutral saddles, where homoclinic orbits change stability.

Two real eigenvalues have zero sum. In a plane that is trace f_u = 0 with det f_u < 0 (Kuznetsov, Elements of Applied
Bifurcation Theory, sec. 6.2). With two parameters they lie on the curve of Hopf points, continued through its
Bogdanov-Takens points, where kappa = omega^2 becomes negative.
"""

from math import nan, sqrt

import numpy as np

from contin.continuation.branch import Parent
from contin.problems.equilibria.equilibrium import EquilibriumProblem
from contin.special.special_type import SpecialType
from contin.transitions.curve_through import seed_of
from contin.transitions.registry import born


def trace_at_saddles(problem, z):
    """tr f_u where det f_u < 0; it has no meaning elsewhere."""
    matrix = problem.linear_part(z)
    return float(np.trace(matrix)) if matrix.shape == (2, 2) and np.linalg.det(matrix) < 0.0 else nan


def eigenvalue(problem, z):
    """The positive eigenvalue; the other one is its negative."""
    return {"eigenvalue": sqrt(-float(np.linalg.det(problem.linear_part(z))))}


TYPE = SpecialType(
    code="NSA", words="neutral saddle", codimension=1, on=("equilibrium",), critical=0,
    condition="two real eigenvalues with zero sum", source="Kuznetsov, sec. 6.2",
    births=("equilibrium_NSA_to_locus",), curves=("HB",),
    marker="X", symbol="saltire", test=trace_at_saddles, form=eigenvalue,
)  # fmt: skip


@born(EquilibriumProblem, "NSA", "the curve of neutral saddles", parameters=2)
def neutral_saddles(problem, point, parameters):
    """Seed of the curve, which contin knows as that of Hopf points with kappa = -eigenvalue^2."""
    p, parent = problem.full_parameters(point.z), Parent.of(point)
    kappa = -(point.normal_form["eigenvalue"] ** 2)
    system, periods = problem.system, problem.angle_periods
    return [seed_of(system, "HB", parameters, point.z[:-1], p, point.scale[:-1], periods, kappa, parent)]
