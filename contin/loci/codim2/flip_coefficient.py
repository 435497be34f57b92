"""The cubic coefficient of period doublings, along their curve."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from contin.abi import Array
from contin.loci.codim2.forms import jet_at
from contin.loci.codim2.uncomputed_tests import untold
from contin.machine import elementary
from contin.normalforms.cubic_of_maps import at_flip

if TYPE_CHECKING:
    from contin.loci.curve_of_points import CurveOfPoints
    from contin.normalforms.jet import Jet


def flip_coefficient(problem: CurveOfPoints, z: Array) -> float:
    """The cubic coefficient of a period doubling in the states' sizes, whose zero is a GPD."""
    try:
        return of_jet(jet_at(problem, z))
    except (ZeroDivisionError, np.linalg.LinAlgError) as error:
        return untold(problem, "GPD", z, error)


def of_jet(jet: Jet) -> float:
    """The same, of c for |q| = 1 in the model's units; raises where it has no finite value."""
    cubic = at_flip(jet)
    q = cubic.right
    return cubic.value.real / elementary.square(float(np.linalg.norm(q if jet.scale is None else q / jet.scale)))
