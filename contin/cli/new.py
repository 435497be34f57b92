"""`contin new`: a small model and a run file for it, ready to change."""

from __future__ import annotations

import re
from pathlib import Path

from contin.errors import InputError

MODEL = """\
contin: 1
name: {name}
title: A system with a Hopf point at mu = 0    # change everything below
states:      {{x: 0.0, y: 0.0}}
parameters:
  mu: {{value: -1, range: [-1, 1]}}
  omega: 1
definitions: {{r2: x^2 + y^2}}
equations:
  x: mu*x - omega*y - x*r2
  y: omega*x + mu*y - y*r2
observables: {{amplitude: sqrt(r2)}}
"""

RUN = """\
contin: 1
model: {name}.yaml
continuations:
  - {{name: rest, parameter: mu}}                        # equilibria over the range of mu
  - {{name: cycles, from: rest.HB1, parameter: mu}}      # the orbits born at the Hopf point
outputs: {{plot: {name}.png}}
"""


def write_templates(name: str) -> int:
    """Write NAME.yaml and NAME-run.yaml into the current folder; existing files are left alone."""
    if not re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9_-]*", name):
        raise InputError(f"{name!r} cannot name files here; use letters, digits, '-' and '_'")
    files = {Path(f"{name}.yaml"): MODEL, Path(f"{name}-run.yaml"): RUN}
    for path in files:
        if path.exists():
            raise InputError(f"{path} is already there; choose another name")
    for path, text in files.items():
        path.write_text(text.format(name=name), encoding="utf-8")
        print(path)
    print(f"Next: contin run {name}-run.yaml")
    return 0
