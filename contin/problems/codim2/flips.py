"""The cubic coefficient of period doublings, along their curve."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from contin.abi import Array
from contin.normalforms.maps import period_doubling
from contin.problems.codim2.forms import jet_at
from contin.problems.codim2.untold import untold

if TYPE_CHECKING:
    from contin.problems.loci.problem import LocusProblem


def flip_coefficient(problem: LocusProblem, z: Array) -> float:
    """The cubic coefficient of a period doubling, whose zero is a GPD."""
    try:
        form = period_doubling(jet_at(problem, z))
    except (ZeroDivisionError, np.linalg.LinAlgError) as error:
        return untold(problem, "GPD", error)
    return float(next(v for k, v in form.coefficients.items() if k == "c"))
