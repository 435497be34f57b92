"""`contin new`: a small model and a run file for it, ready to change."""

from __future__ import annotations

import re
from pathlib import Path

from contin.errors import InputError

MODEL = """\
contin: 1                                 # format version
name: {name}
title: A system with a Hopf point at mu = 0
# source: "who wrote these equations, and where"

states:                                   # the order of the vector; the value is the first guess of a run
  x: 0.0
  y: 0.0                                  # long form: {{value: 0, unit: mV, description: ..}}; angles add period: 2*pi
parameters:
  mu: {{value: -1, range: [-1, 1]}}         # the range is what runs cover unless they say otherwise
  omega: 1
definitions:                              # named formulas, in any order
  r2: x^2 + y^2
equations:                                # dx/dt = ...; with `kind: map` above, the next x = ...
  x: mu*x - omega*y - x*r2                # ^ or ** is power; sin, exp, sqrt, ..., and `a if c else b`
  y: omega*x + mu*y - y*r2
observables:                              # recorded along every branch beside the states
  amplitude: sqrt(r2)
starts:                                   # points that runs can name; formulas in the parameters are welcome
  rest: {{x: 0, y: 0}}
expect:                                   # optional; `contin check {name}.yaml --run` verifies it
  - {{label: HB, at: {{mu: 0}}, tolerance: 1e-8, run: {{start: rest, parameter: mu, range: [-1, 1]}}}}
"""

RUN = """\
contin: 1
model: {name}.yaml                        # a file beside this one, or a name that `contin models` lists
parameters: {{omega: 1}}                    # values that differ from the model's
continuations:                            # in this order; a later one may start at a point of an earlier one
  - {{name: rest, start: rest, parameter: mu, range: [-1, 1]}}      # equilibria
  - {{name: cycles, from: rest.HB1, parameter: mu, range: [-1, 1]}} # the periodic orbits born at the Hopf point
# diagram: {{parameter: mu, range: [-1, 1]}}                        # or: find and follow everything by itself
outputs: {{plot: {name}.png, json: {name}.json, x: mu, y: x}}
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
