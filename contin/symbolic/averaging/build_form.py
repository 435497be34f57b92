"""The averaged system in the form that is asked for."""

from __future__ import annotations

from contin.symbolic.averaging.amplitudes import SlowSystem
from contin.symbolic.averaging.form_cartesian import cartesian_form
from contin.symbolic.averaging.form_polar import polar_form
from contin.symbolic.averaging.form_stokes import stokes_form
from contin.symbolic.averaging.forms import AveragedForm


def build_form(system: SlowSystem, name: str) -> AveragedForm:
    """The averaged system in the form 'polar', 'cartesian' or 'stokes'."""
    builders = {"polar": polar_form, "cartesian": cartesian_form, "stokes": stokes_form}
    return builders[name](system)
