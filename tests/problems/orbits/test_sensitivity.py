"""How far a special orbit moves where the equations have errors: beside equations that really have them."""

from __future__ import annotations

import numpy as np
import pytest

from contin.model.model import Model
from contin.model.printing import to_text
from contin.problems.orbits.linearised.linear import OrbitLinear
from contin.problems.orbits.special_orbits.sensitivity import sensitivity
from tests.truth.planted_orbits import SIMPLE, Hidden

ERROR = 1e-6


class Perturbed(Hidden):
    """Every equation off by about `ERROR`, relative to it and to the rates, in a way of its own; so are derivatives."""

    @property
    def model(self) -> Model:
        exact = Hidden(self.core, self.n, self.way, self.seed).model
        names = [state.name for state in exact.states]
        return Model(
            "perturbed", states=dict(zip(names, self.points(np.zeros(1))[0].tolist(), strict=True)),
            parameters=dict(self.core.start), definitions={n: to_text(e) for n, e in exact.definitions.items()},
            equations={
                name: f"({to_text(equation)})*(1 + {ERROR * (-1.0) ** k}*sin({names[0]} + {k}))"
                + f" + {ERROR / 2}*{name}" * (k > 1)
                for k, (name, equation) in enumerate(zip(names, exact.equations, strict=True))
            },
        )  # fmt: skip


CORES = [core for core in SIMPLE if "sub" not in core.name]
BENT = ("LPC, period changing", "NS, supercritical")  # each costs three of the plain ones
CASES = [
    pytest.param(core, n, way, id=f"{n}-{way}-{core.name}", marks=[pytest.mark.long] if long else [])
    for n, way in ((4, "plain"), (5, "bent"))
    for core in CORES
    for long in [way == "bent" and core.name not in BENT]
]


@pytest.mark.parametrize(("core", "n", "way"), CASES)
@pytest.mark.seldom
def test_a_bound_of_how_far_errors_of_the_equations_move_a_special_orbit(core, n, way):
    family = Hidden(core, n, way, 3).family()
    (point,) = (point for point in family.points if point.type == core.type)
    problem, scale = point.problem, point.scale
    theta = point.vectors.get("theta", 0.0)
    bound = sensitivity(OrbitLinear(problem, point.z, scale, point.z), core.type, theta) * float(scale[-1])
    assert 0.0 < bound < 1e3
    moved = [p.z[-1] for p in Perturbed(core, n, way, 3).family().points if p.type == core.type]
    if core.type == "BPC" and not moved:
        return  # of errors in rotated coordinates no branch point is left
    assert len(moved) == 1
    assert abs(moved[0] - point.z[-1]) <= ERROR * bound
