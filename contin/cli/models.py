"""`contin models`: what can be named under `model:`."""

from __future__ import annotations

from contin.model.bundled import runs
from contin.model.registry import listing
from contin.model.yaml_reader import read_file


def list_models() -> int:
    """Print every bundled and plugin model with its title, then the bundled run files."""
    lines = listing()
    width = max((len(line.name) for line in lines), default=0)
    for line in lines:
        origin = "" if line.source == "contin" else f"  [{line.source}]"
        print(f"{line.name:{width}}  {line.title}{origin}".rstrip())
    known = runs()
    width = max((len(name) for name in known), default=0)
    if known:
        print("\nRun files (contin run NAME; they write into the current folder)")
    for name, path in known.items():
        data = read_file(path).data
        print(f"{name:{width}}  {data.get('title', '') if isinstance(data, dict) else ''}".rstrip())
    return 0
