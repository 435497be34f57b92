"""The options of a picture, added to every command that draws, which gets them as one mapping."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from functools import wraps
from typing import Annotated, Any, Final

import typer

Look = dict[str, Any] | None  # what `pictured` gathers
OPTIONS: Final[dict[str, tuple[Any, Any]]] = {
    "log": (
        Annotated[list[str] | None, typer.Option("--log", help="Column with a logarithmic axis; repeatable.")], None
    ),
    "limits": (
        Annotated[list[str] | None, typer.Option("--limits", help="COLUMN=LOW,HIGH: ends of an axis; repeatable.")],
        None,
    ),
    "labels": (
        Annotated[str | None, typer.Option("--labels", help="Types whose labels are written, as LP,HB; or none.")],
        None,
    ),
    "size": (Annotated[str | None, typer.Option("--size", help="WIDTH,HEIGHT of the picture in inches.")], None),
    "legend": (Annotated[str, typer.Option("--legend", help="below, inside or none.")], "below"),
    "title": (Annotated[str | None, typer.Option("--title", help="Written over the picture.")], None),
}  # fmt: skip


def pictured(command: Callable[..., None]) -> Callable[..., None]:
    """The command with these options; its last parameter, `look`, is a mapping of them."""
    own = inspect.signature(command, eval_str=True)
    kept = [parameter for name, parameter in own.parameters.items() if name != "look"]
    added = [
        inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=annotation)
        for name, (annotation, default) in OPTIONS.items()
    ]

    @wraps(command)
    def told(**given: object) -> None:
        command(look={name: given.pop(name) for name in OPTIONS}, **given)

    told.__signature__ = own.replace(parameters=[*kept, *added])  # type: ignore[attr-defined]
    return told
