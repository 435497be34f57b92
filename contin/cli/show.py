"""`contin show`: the equations of a model."""

from __future__ import annotations

import typer

from contin.model.registry import load


def show_model(reference: str, latex: bool, yaml: bool) -> int:
    """Print the equations as text, in LaTeX, or as a model file; exit code."""
    model = load(reference)
    typer.echo(model.latex() if latex else model.text().rstrip("\n") if yaml else str(model))
    return 0
