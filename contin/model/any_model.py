"""What registry, run files and reports ask of a model, whether it is made of formulas or a Python function."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Protocol, runtime_checkable


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

    def default_parameters(self, overrides: Mapping[str, Any] | None = None) -> dict[str, float]: ...

    def parameter_range(self, name: str, overrides: Mapping[str, Any] | None = None) -> tuple[float, float] | None: ...

    def start_point(self, start: Any = None, parameters: Mapping[str, Any] | None = None) -> tuple[Any, Any]: ...

    def periods(self, overrides: Mapping[str, Any] | None = None) -> Any: ...

    def text(self) -> str: ...
