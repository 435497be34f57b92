"""Curves of orbits with sparse equations that the march in Python follows: connecting orbits, orbits of one period."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation import march as python_march
from contin.continuation.problem import Chunk, Frame, Sample, is_planar
from contin.continuation.settings import Settings
from contin.errors import InputError
from contin.problems.orbits.two_parameters import OrbitCurveProblem

TOLERANCE = 1e-11  # of Newton's steps with one unknown fixed


class MarchedInPython(OrbitCurveProblem):
    """`curve.unknowns(z)` are the places that the equations are solved for; the rest of z is carried along."""

    maximum_chunk: int

    @abstractmethod
    def settle(self, z: Array, scale: Array) -> None:
        """Take z as what the phase condition, and all else that is kept for a chunk, refers to."""

    @abstractmethod
    def linearisation(self, z: Array, tangent: Array, scale: Array) -> python_march.Linearisation | None:
        """The factorised equations with the tangent as their last row; None where they are singular."""

    @abstractmethod
    def stability(self, z: Array) -> tuple[Array, int, NDArray[np.complex128]]:
        """Tests from index 2 on, the number of unstable eigenvalues or multipliers, and all of these."""

    def again_in(self, scale: Array) -> python_march.Again | None:
        """How the factors of one point serve at another, see `contin.continuation.march.correct`; None: not at all."""
        return None

    def tangents(self, z: Array, scale: Array) -> Sequence[Array]:
        """The curve's own tangent: the null vector of its equations."""
        self.settle(z, scale)
        border = np.zeros(z.size)
        where = self.curve.unknowns(z)
        border[where] = np.random.default_rng(3).normal(size=where.size)
        tangent = python_march.null_vector(self, z, scale, border, 2)
        if tangent is None:
            raise InputError("the curve cannot be followed from here: its equations are singular")
        return [tangent]

    def march(
        self, origin: Sample, before: Sample | None, length: float, frame: Frame, step: float, limit: int,
        bounds: tuple[float, float], settings: Settings, loop: Sample | None,
    ) -> Chunk:  # fmt: skip
        self.settle(origin.z, frame.scale)
        limit = min(limit, self.maximum_chunk)
        planar = self if is_planar(self) else replace(self, first_bounds=bounds)  # then there is no `within`
        return python_march.march(
            self, origin, before, length, frame, step, limit, bounds, settings, None, self.again_in(frame.scale), planar
        )

    def probe(self, base: Sample, length: float, guess: Array, frame: Frame, settings: Settings) -> Sample | None:
        return python_march.probe(self, base, length, guess, frame, settings)

    def at_unknown(self, index: int, guess: Array, value: float, scale: Array) -> Array | None:
        return python_march.with_one_fixed(self, index, guess, value, scale, TOLERANCE)
