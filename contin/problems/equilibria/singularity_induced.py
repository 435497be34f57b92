"""Equilibria that come to a singularity of the algebraic equations: an eigenvalue passes through infinity there.

The branch of equilibria itself goes on smoothly (a singularity-induced bifurcation: Venkatasubramanian, Schaettler and
Zaborszky, IEEE Trans. Autom. Control 40 (1995) 1992), but the flow does not: beyond, the index has been above 1, and
solutions that begin beside it do not lead across. The branch ends there and says so. So does one along which a mass
changes its sign: where it vanishes its equation is algebraic, and a rate infinite.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np

from contin.abi import Array
from contin.continuation.branch import End
from contin.continuation.problem import Renewal
from contin.continuation.sample import Chunk, Frame, Sample, Stop
from contin.lowering.system import CompiledSystem
from contin.simulate.reach import POLE
from contin.systems.protocol import System

NEAR: Final = 1e-4  # scaled length of a step across the singularity from which it is approached no further
NEAR_MASSLESS: Final = 1e-7  # the same, of a vanishing mass: nothing but rates grow there
SHORTER: Final = 8.0
AHEAD: Final = 4.0  # in units of NEAR: where the singularity is looked for
ITERATIONS: Final = 3
CLOSER: Final = 0.5  # part of the way that is left: what is solved for next to the singularity is rounding
ROUNDED: Final = 1e-13  # of a parameter that is extrapolated

Probe = Callable[[Sample, float], Sample | None]


def has_poles(system: System) -> bool:
    """True where a branch may come to a singularity of algebraic equations, or to a mass that vanishes."""
    return isinstance(system, CompiledSystem) and bool(system.vanishing or system.constraints is not None)


def cut_before_pole(system: System, chunk: Chunk, parameters: Array, n: int) -> Chunk:
    """The chunk up to the first step across a singularity, or to the row that is `NEAR` it; parameters : of its rows.

    Closer to it corrections and eigenvalues are rounding: what is divided by vanishes.
    """
    if not isinstance(system, CompiledSystem) or len(chunk) < 2:
        return chunk
    if system.vanishing:
        chunk = _cut_before_massless(system, chunk, parameters, n)
    if system.constraints is None or len(chunk) < 2:
        return chunk
    parameters = parameters[: len(chunk)]
    values = system.index_determinants(np.ascontiguousarray(chunk.z[:, :n]), parameters)
    beyond = np.flatnonzero(~(values * np.sign(values[0]) > 0.0))
    first = int(beyond[0]) if beyond.size else len(chunk)
    size = np.abs(values[:first])
    close = np.flatnonzero(size[1:] * (chunk.lengths[1:first] + NEAR) < size[:-1] * NEAR)
    if close.size:
        row = int(close[0]) + 1
        return chunk.cut(row + 1, Stop.CORRECTOR, float(chunk.lengths[row]))
    if not beyond.size:
        return chunk
    return _nearer(chunk, max(first, 1), NEAR)


def _nearer(chunk: Chunk, row: int, near: float) -> Chunk:
    """The chunk before a row that is across, with a shorter step to go on with, down to `near`."""
    length = float(chunk.lengths[row])
    if length > near:
        return chunk.cut(row, Stop.LIMIT, max(length / SHORTER, 0.5 * near))
    return chunk.cut(row, Stop.CORRECTOR, length)


def _cut_before_massless(system: CompiledSystem, chunk: Chunk, parameters: Array, n: int) -> Chunk:
    values = system.masses(np.ascontiguousarray(chunk.z[:, :n]), parameters)
    beyond = np.flatnonzero((~(values * np.sign(values[0]) > 0.0)).any(axis=1))
    return _nearer(chunk, max(int(beyond[0]), 1), NEAR_MASSLESS) if beyond.size else chunk


def end_without_mass(
    system: System, origin: Sample, frame: Frame, name: str, rows_of_parameters: Callable[[Array], Array]
) -> Renewal | None:
    """The end of a branch just before a parameter at which a mass vanishes; None where there is none ahead.

    name : of the parameter, on which alone masses depend.  rows_of_parameters : of points z (N, n + 1).
    """
    if not isinstance(system, CompiledSystem) or not system.vanishing:
        return None
    z = np.array([origin.z, origin.z + AHEAD * NEAR_MASSLESS * frame.scale * origin.tangent])
    values = system.masses(np.ascontiguousarray(z[:, : len(system.state_names)]), rows_of_parameters(z))
    for mass, along in zip(system.vanishing, values.T, strict=True):
        if np.sign(along[0]) == np.sign(along[1]) != 0.0:  # (a product may be too small for a number)
            continue
        share = along[0] / (along[0] - along[1])
        at = float(z[0, -1] + share * (z[1, -1] - z[0, -1]))
        text = f"{name} comes to {at:.6g}, where {mass.words()}"
        return Renewal(frame.scale, origin, None, None, End("bound", text, {"at": {name: at}}))
    return None


def end_at_pole(
    system: System, origin: Sample, frame: Frame, name: str, determinant: Callable[[Array], float], probe: Probe
) -> Renewal | None:
    """The end of a branch just before a singularity; None where there is none ahead.

    name : of the parameter.  determinant : at a point z.  probe : the point of the branch at a length from a sample.
    """
    if not isinstance(system, CompiledSystem) or system.constraints is None:
        return None
    b = AHEAD * NEAR
    zb = origin.z + b * frame.scale * origin.tangent
    here, there = determinant(origin.z), determinant(zb)
    if not here * there < 0.0:
        return None
    lengths, values, parameters = [0.0], [here], [float(origin.z[-1])]
    zero = b * here / (here - there)
    for _ in range(ITERATIONS):
        found = probe(origin, lengths[-1] + CLOSER * (zero - lengths[-1]))
        if found is None:  # too close to it to be solved for
            break
        lengths.append(lengths[-1] + CLOSER * (zero - lengths[-1]))
        values.append(determinant(found.z))
        parameters.append(float(found.z[-1]))
        if not values[-1] * values[-2] > 0.0 or values[-1] == values[-2]:
            break
        zero = lengths[-1] - values[-1] * (lengths[-1] - lengths[-2]) / (values[-1] - values[-2])
    at, error = _where_zero(np.array(values), np.array(parameters))
    if len(values) == 1:
        at = float(origin.z[-1] + zero * frame.scale[-1] * origin.tangent[-1])
        error = abs(at - float(origin.z[-1]))
    text = f"at {name} = {at:.10g} +- {error:.1e}, {POLE.format(', '.join(system.constraints.equations))}"
    return Renewal(frame.scale, origin, None, None, End("bound", text, {"at": {name: at}, "error": error}))


def _where_zero(values: Array, parameters: Array) -> tuple[float, float]:
    """The parameter where a value vanishes, by the polynomial through all of them (Neville), and its error.

    The error is what the two farthest points change: those next to the singularity are solved to no more than rounding.
    """
    column, known = parameters.copy(), [float(parameters[-1])]
    for k in range(1, len(values)):
        column = (values[k:] * column[:-1] - values[:-k] * column[1:]) / (values[k:] - values[:-k])
        known.append(float(column[-1]))
    return known[-1], 2.0 * float(np.sum(np.abs(np.diff(known[-3:])))) + ROUNDED * abs(known[-1])
