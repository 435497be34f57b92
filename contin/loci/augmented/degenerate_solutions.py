"""Points of one codimension more on curves of folds and branch points of boundary-value problems."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from contin.abi import Array
from contin.bvp.kernel_at_branch_point import smallest
from contin.bvp.on_mesh import OnMesh
from contin.bvp.special_points import form_of_branch_point
from contin.continuation.outcome import Outcome, Rejected, Verified
from contin.loci.augmented import boundary_degeneracies as degeneracies
from contin.loci.augmented.boundary_degeneracies import Critical
from contin.loci.augmented.elimination import Scalars
from contin.loci.augmented.singular import singular

if TYPE_CHECKING:
    from contin.loci.augmented.singular_solutions import SingularSolutions


def critical_at(base: SingularSolutions, z: Array) -> Critical | None:
    """The null vectors by the borders in use, near z; None where there are none."""
    unit = np.ones(z.size)
    where = np.delete(base.where(z), base.unfolding(z))
    mesh = OnMesh(base.at(z), base.profile(z).h)
    on_mesh = base.on_mesh(mesh.h, unit[where])
    here = on_mesh.at(z[where])
    if here is None:
        return None
    found = singular(on_mesh, z[where], here.critical(base.extra == 1), base.borders_at(z, unit), slopes=False)
    if found is None:
        return None
    return Critical(mesh, mesh.unknowns(base.inner(z)), here, found.left, found.right)


def scalar(base: SingularSolutions, name: str, z0: Array) -> Scalars:
    """What vanishes at points of a name (`boundary_degeneracies`), measured by the equations' terms at z0."""
    own, there = degeneracies.name_in(name, base.kind), critical_at(base, z0)
    unit = 1.0
    if there is not None:
        width = abs(float(z0[-1])) or 1.0
        unit = degeneracies.unit_of(own, there, base.node_sizes(z0), width)

    def value(z: Array) -> Array:
        at = critical_at(base, z)
        return np.full(1, np.nan if at is None else degeneracies.VALUES[own](at) / unit)

    return value


def described(base: SingularSolutions, point: Verified, scale: Array) -> Outcome:
    """Points on curves of branch points with the coefficients of the reduced equation."""
    name = degeneracies.TYPE_OF.get(point.type, point.type)
    mesh = OnMesh(base.at(point.z), base.profile(point.z).h)
    x, sizes = mesh.unknowns(base.inner(point.z)), mesh.unknowns(base.inner(scale))
    form = form_of_branch_point(mesh, x, smallest(mesh, x), point.error, sizes)
    if name == "DP" and base.kind == degeneracies.PITCHFORK and form["kind"] == "transcritical":
        return Rejected("DP not labelled: the pitchfork at which the curve began is none elsewhere")
    return replace(point, type=name, normal_form=form)


def kind_at(base: SingularSolutions, z: Array, scale: Array) -> str:
    """Of the branch point z: transcritical, pitchfork, ..."""
    mesh = OnMesh(base.at(z), base.profile(z).h)
    x, sizes = mesh.unknowns(base.inner(z)), mesh.unknowns(base.inner(scale))
    return str(form_of_branch_point(mesh, x, smallest(mesh, x), 0.0, sizes)["kind"])
