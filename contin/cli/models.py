"""`contin models`: what can be named under `model:`."""

from __future__ import annotations


def list_models() -> int:
    """Print every bundled and plugin model with its title."""
    from contin.model.registry import listing

    lines = listing()
    width = max((len(line.name) for line in lines), default=0)
    for line in lines:
        origin = "" if line.source == "contin" else f"  [{line.source}]"
        print(f"{line.name:{width}}  {line.title}{origin}".rstrip())
    return 0
