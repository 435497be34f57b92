"""Every integration in a look for returns keeps to the steps that it was given: a trajectory may escape in any."""

from __future__ import annotations

import numpy as np
import pytest

from contin.api import compiled
from contin.model.model import Model
from contin.search import orbit_by_simulation
from contin.simulate.trajectory import integrate

OSCILLATOR = Model("van der Pol", states={"x": 1.0, "y": 0.0}, parameters={"e": 0.5},
                   equations={"x": "y", "y": "e*(1 - x^2)*y - x"})  # fmt: skip
TURNING = Model("turning", states={"s": {"value": 0.0, "period": "2*pi"}}, parameters={"w": 1.0},
                equations={"s": "w + 0.3*sin(s)"})  # fmt: skip


@pytest.mark.parametrize("model", [OSCILLATOR, TURNING], ids=lambda model: model.name)
def test_all_integrations_have_the_budget(model, monkeypatch):
    given = []

    def watched(*arguments, **options):
        given.append(options.get("budget"))
        return integrate(*arguments, **options)

    monkeypatch.setattr(orbit_by_simulation, "integrate", watched)
    u, p = model.start_point()
    periods = np.array([2 * np.pi if state.period else 0.0 for state in model.states])
    found = orbit_by_simulation.find_return(compiled(model), u, p, periods, budget=54_321)
    assert found.distance < 1e-3
    assert len(given) > 1
    assert set(given) == {54_321}
