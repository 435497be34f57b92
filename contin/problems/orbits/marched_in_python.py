"""Curves of orbits with sparse equations that the march in Python follows: connecting orbits, orbits of one period."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import replace
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation import corrector
from contin.continuation import march as python_march
from contin.continuation.problem import in_two_parameters
from contin.continuation.sample import Chunk, Frame, Sample
from contin.continuation.settings import Settings
from contin.errors import InputError
from contin.problems.orbits.two_parameters import OrbitCurveProblem
from contin.problems.tolerances import ONE_FIXED


class MarchedInPython(OrbitCurveProblem):
    """`curve.unknowns(z)` are the places that the equations are solved for; the rest of z is carried along."""

    maximum_chunk: int

    def settled(self, z: Array, scale: Array) -> Self:
        """The same curve, z being what the phase condition, and all else that is chosen for a chunk, refers to."""
        return replace(self, curve=self.curve.settled(z, scale))

    def with_gauge(self, gauge: Any) -> Self:
        """The same curve with what was chosen for a chunk, if there is one."""
        return self if gauge is None else replace(self, curve=self.curve.gauged(gauge))

    def near(self, z: Array, frame: Frame) -> Self:
        """The curve as it is looked at next to a chunk; where there is none, as it was set out with, or next to z."""
        own = self.with_gauge(frame.gauge)
        return own if own.curve.is_settled else own.settled(z, frame.scale)

    @abstractmethod
    def linearisation(self, z: Array, tangent: Array, scale: Array) -> corrector.Linearisation | None:
        """The factorised equations with the tangent as their last row; None where they are singular."""

    @abstractmethod
    def stability(self, z: Array) -> tuple[Array, int, NDArray[np.complex128]]:
        """Tests from index 2 on, the number of unstable eigenvalues or multipliers, and all of these."""

    def tangents(self, z: Array, scale: Array) -> Sequence[Array]:
        """The curve's own tangent: the null vector of its equations."""
        border = np.zeros(z.size)
        where = self.curve.unknowns(z)
        border[where] = np.random.default_rng(3).normal(size=where.size)
        tangent = python_march.null_vector(self.settled(z, scale), z, scale, border, 2)
        if tangent is None:
            raise InputError("the curve cannot be followed from here: its equations are singular")
        return [tangent]

    def march(
        self, origin: Sample, before: Sample | None, length: float, frame: Frame, step: float, limit: int,
        bounds: tuple[float, float], settings: Settings, loop: Sample | None,
    ) -> Chunk:  # fmt: skip
        limit = min(limit, self.maximum_chunk)
        walled = self if in_two_parameters(self) else replace(self, first_bounds=bounds)  # then there is no `within`
        own = self.with_gauge(frame.gauge).settled(origin.z, frame.scale)
        chunk = python_march.march(
            own, origin, before, length, frame, step, limit, bounds, settings, None, walled=walled
        )
        return replace(chunk, gauge=own.curve.gauge)

    def probe(self, base: Sample, length: float, guess: Array, frame: Frame, settings: Settings) -> Sample | None:
        return python_march.probe(self.near(base.z, frame), base, length, guess, frame, settings)

    def at_unknown(self, index: int, guess: Array, value: float, scale: Array) -> Array | None:
        own = self.settled(guess, scale)
        return python_march.with_one_fixed(own, index, guess, value, scale, ONE_FIXED)
