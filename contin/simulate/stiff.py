"""Stiff flows: scipy's implicit methods with the compiled equations and their exact Jacobian."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from contin.abi import Array
from contin.simulate.with_mass import integrate_with_mass
from contin.systems.functions.function_system import FunctionSystem
from contin.systems.protocol import HasSlopes

if TYPE_CHECKING:
    from contin.lowering.system import CompiledSystem

CALLS = 5_000_000  # of the right-hand side
NONSMOOTH = "a piecewise-smooth flow: corners are stepped over by error control alone, and sliding is not noticed"


class _TooManyCallsError(Exception):
    """The budget of calls is used up."""


def integrate_stiff(
    system: CompiledSystem | FunctionSystem, u: Array, p: Array, times: Array, method: str, rtol: float, atol: Array,
    box: float,
) -> tuple[Array, Array, int, str, str]:
    """(t, states, steps, outcome, why) with the states at `times` as far as the solution goes; from t = 0.

    Radau (order 5), BDF (orders 1 to 5) and LSODA (switches to Adams' method where the flow is not stiff): Hairer and
    Wanner, Solving Ordinary Differential Equations II; scipy.integrate.solve_ivp.
    """
    from scipy.integrate import solve_ivp

    if isinstance(system, FunctionSystem) and system.model.mass_matrix is not None:
        if method == "Radau":
            return integrate_with_mass(system, u, p, times, rtol, atol, box)
        system = FunctionSystem(system.model.divided())
    n, full = system.n, np.append(p, 0.0) if system.is_forced else np.array(p, dtype=float)
    calls = 0

    def slope(t: float, y: Array) -> Array:
        nonlocal calls
        calls += 1
        if calls > CALLS:
            raise _TooManyCallsError
        if system.is_forced:
            full[-1] = t
        return np.asarray(system.value(y, full))

    def jacobian(t: float, y: Array) -> Any:
        if system.is_forced:
            full[-1] = t
        return system.slopes(y, full) if isinstance(system, HasSlopes) else system.jacobian(y, full)[1][:, :n]

    def outside(t: float, y: Array) -> float:
        return box - float(np.abs(y).max())

    outside.terminal = True  # type: ignore[attr-defined]
    events = outside if box < 1e99 else None
    try:
        with np.errstate(all="ignore"):
            solved = solve_ivp(
                slope, (0.0, float(times[-1])), u, method=method, jac=jacobian, rtol=max(rtol, 3e-14), atol=atol,
                t_eval=times, events=events,
            )  # fmt: skip
    except _TooManyCallsError:
        return times[:0], np.empty((0, n)), calls, "stopped", f"{CALLS} evaluations of the equations were not enough"
    except ValueError as error:  # LU of a Jacobian that is not finite
        return times[:0], np.empty((0, n)), calls, "stopped", f"the equations are not finite on the way ({error})"
    states = solved.y.T if len(solved.t) else np.empty((0, n))
    steps = int(solved.nfev)
    if solved.status == 1:
        when = float(solved.t_events[0][0])
        return solved.t, states, steps, "escaped", f"left the box at t = {when:.6g}: a state exceeds {box:.6g}"
    if solved.status < 0:
        return solved.t, states, steps, "stopped", str(solved.message)
    return solved.t, states, steps, "done", ""
