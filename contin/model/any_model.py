"""What registry, run files and reports ask of a model, whether it is made of formulas or a Python function."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol, runtime_checkable

from contin.records import Json, Record


@runtime_checkable
class AnyModel(Protocol):
    """`Model` and `FunctionProblem`; a plugin may give either."""

    @property
    def name(self) -> str: ...

    @property
    def title(self) -> str | None: ...

    @property
    def state_names(self) -> Sequence[str]: ...

    @property
    def parameter_names(self) -> Sequence[str]: ...

    def default_parameters(self, overrides: Record | None = None) -> dict[str, float]: ...

    def parameter_range(self, name: str, overrides: Record | None = None) -> tuple[float, float] | None: ...

    def start_point(self, start: Json = None, parameters: Record | None = None) -> tuple[Any, Any]: ...

    def periods(self, overrides: Record | None = None) -> Any: ...

    def text(self) -> str: ...
