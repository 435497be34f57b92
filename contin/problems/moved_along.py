"""Orbits that are seen from a moving frame: how far they return moved, and where the frame has hardly a phase."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from contin.abi import Array
from contin.systems.functions.given_function import GivenFunction
from contin.systems.functions.moving_frame import MovingFrame

if TYPE_CHECKING:
    from contin.systems.protocol import System


def frame_of(system: System) -> MovingFrame | None:
    """The frame of a function that is seen from one."""
    model: object = system.model
    return model.frame if isinstance(model, GivenFunction) else None


def distances(system: System, measured: Callable[[int], Array]) -> dict[str, Array]:
    """The column of what orbits return moved; `measured` integrates the observable of a number over their periods."""
    frame = frame_of(system)
    return {} if frame is None else {frame.column: measured(system.observable_names.index(frame.rate))}


def distance_name(system: System) -> tuple[str, ...]:
    """The name of that column."""
    frame = frame_of(system)
    return () if frame is None else (frame.column,)


def remarks_on_frame(system: System, states: Array) -> Sequence[str]:
    """Where the frame has hardly a phase at one of the states (K, n) of an orbit."""
    frame = frame_of(system)
    text = None if frame is None else frame.weakness(states)
    return () if text is None else (text,)
