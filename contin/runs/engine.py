"""The verbs of contin as the executor calls them: the only place where run files meet the numerical engine."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Protocol

from contin.continuation.branch import Branch

if TYPE_CHECKING:
    from contin.model.model import Model
    from contin.runs.plan import DiagramPlan, RunPlan

Watcher = Callable[[Mapping[str, Any]], None]


class Found(Protocol):
    """What the explorer returns."""

    @property
    def branches(self) -> Iterable[Branch]: ...

    @property
    def notes(self) -> Sequence[str]: ...


class Engine(Protocol):
    """What the executor needs; tests put a double in its place."""

    def start(self, model: Model, run: RunPlan, parameters: Mapping[str, Any]) -> Any:
        """The start of a run from the model's starts."""

    def start_at_point(self, branch: Branch, label: str, run: RunPlan) -> Any:
        """The start of a run from a labelled point of a branch."""

    def continuation(self, start: Any, run: RunPlan) -> Iterable[Branch]:
        """The branch, and after it those that are its images under declared symmetries."""

    def diagram(self, model: Model, diagram: DiagramPlan, parameters: Mapping[str, Any]) -> Found:
        """Everything that is connected to the starts."""
