"""Forms of averaged systems that packages add: other coordinates for the states of a form that is there.

    [project.entry-points."contin.averaging"]
    energy = "package.module:FORM"          # a `NewForm`

Then `average: {form: energy}` is known in run files, and `contin.average(model, form="energy")`.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib.metadata import EntryPoint, entry_points
from typing import Final

from contin.errors import InputError
from contin.model.model import Model
from contin.symbolic.passes.coordinates import change_coordinates

GROUP: Final = "contin.averaging"
Formulas = Mapping[str, str]


@dataclass(frozen=True)
class NewForm:
    """New coordinates for the states of the form `base`: polar, cartesian or stokes.

    With `old` the names of the base form's states, `states(old)` gives each new state as a formula in the old ones,
    `inverse(old)` each old state in the new ones, and `periods(old)` those of new states that are angles.
    """

    base: str
    states: Callable[[tuple[str, ...]], Formulas]
    inverse: Callable[[tuple[str, ...]], Formulas]
    periods: Callable[[tuple[str, ...]], Formulas] = lambda _: {}


def names_of_packages() -> list[str]:
    """The forms that packages add; nothing is imported."""
    return sorted(_entries())


def form_of_package(name: str) -> NewForm | None:
    """The form of this name, or None where no package gives it."""
    entry = _entries().get(name)
    if entry is None:
        return None
    try:
        form = entry.load()
    except Exception as error:  # whatever a package raises on import is its own mistake
        raise InputError(f"averaging: the form {name} of a package cannot be loaded: {error}") from error
    if not isinstance(form, NewForm):
        raise InputError(f"averaging: the entry point {name} of {GROUP} must be a NewForm; it is {type(form).__name__}")
    return form


def in_new_form(model: Model, name: str, form: NewForm) -> Model:
    """An averaged model of the base form in the new coordinates."""
    old = model.state_names
    result = change_coordinates(model, dict(form.states(old)), dict(form.inverse(old)), dict(form.periods(old)))
    title = (model.title or model.name).replace(f"({form.base} form)", f"({name} form)")
    return result.replace(title=title)


def _entries() -> dict[str, EntryPoint]:
    if os.environ.get("CONTIN_PLUGINS") == "0":
        return {}
    return {entry.name: entry for entry in entry_points(group=GROUP)}
