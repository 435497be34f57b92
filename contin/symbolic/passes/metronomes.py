"""Metronomes on movable platforms, from their mechanics (Kato and Kori): any number, alike or not.

    m_i x_i'' + k_i x_i + gamma_i x_i' - delta_i f_i + m_i X'' = 0,   the centre of mass at rest,

made dimensionless with omega = sqrt(k_1/m_1), x_i in units delta_i/k_i, mu_i = m_i/(eps M), beta_i = omega gamma_i/(eps
k_i), kappa_i = k_i/k_1, rho_i = delta_i/delta_1 and f_i = eps g_i.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from contin.errors import InputError
from contin.model.model import Model
from contin.records import Fields, Record
from contin.symbolic.passes.escapements import escapement_of
from contin.symbolic.passes.mechanics import mechanical_model

ESCAPEMENT = "a*x^3 - b*x^5 if x*y > 0 else 0"
GAINS = {"a": 4, "b": 1}


def metronomes(
    count: int = 2,
    *,
    alike: bool = True,
    escapement: str = ESCAPEMENT,
    parameters: Record | None = None,
    platforms: object = None,
    places: Sequence[object] | None = None,
    spring: float = 0.1,
) -> Model:
    """Equations of motion of `count` metronomes, ready for `contin.average`.

    alike : one mu and one beta; otherwise mu1 .., beta1 .., and for i > 1 kappa_i, rho_i (equal by default).
        Frequencies are near-identical where kappa_i mu_1/mu_i is near 1.
    escapement : g(x, y) as a formula in x, y and `parameters`, which default to a = 4, b = 1; or the name of one
        (cubic, constant, van_der_pol, or of a package), with its own parameters.
    platforms : a networkx graph; its edges are springs of stiffness `spring` (per mass of a platform) between platforms
        of equal mass, and `places` says on which node each metronome stands. Default: one platform. Platforms follow
        their load at the metronomes' frequency: the coupling of i and j is mu (1 - spring L)^-1 between their places
        (L the Laplacian of the graph), exact to first order in eps.

    Raises
    ------
    InputError
        The graph is in resonance with the metronomes (an eigenvalue of spring L near 1), or a place is no node.
    """
    given = dict(GAINS if parameters is None else parameters)
    if escapement.isidentifier():
        named = escapement_of(escapement)
        escapement, given = named.formula, {**named.parameters, **(parameters or {})}
    names = [f"x{i + 1}" for i in range(count)]
    if platforms is not None:
        return _on_graph(names, escapement, given, platforms, places, spring)
    if count < 1:
        raise InputError(f"metronomes: count must be 1 or more; got {count}")
    mass, damping, stiffness, unit = _names(count, alike)
    equations = []
    for q, beta, w, s in zip(names, damping, stiffness, unit, strict=True):
        force = f"dd{q} + ({w})*({q} + eps*({beta}*d{q} - sigma*{q}^3 - g({q}, d{q}))) + ddX/({s})"
        equations.append(force)
    loads = " + ".join(f"eps*{mu}*({s})*dd{q}" for q, mu, s in zip(names, mass, unit, strict=True))
    total = " + ".join(f"eps*{mu}" for mu in mass)
    equations.append(f"(1 + {total})*ddX + {loads}")
    values: Fields = {}
    for mu, beta in zip(mass, damping, strict=True):
        values |= {mu: 8, beta: 0.8}
    if not alike:
        for i in range(1, count):
            values |= {f"kappa{i + 1}": f"mu{i + 1}/mu1", f"rho{i + 1}": f"kappa{i + 1}"}
    return _model(names, equations, {**values, **given}, escapement, ["X"], alike)


def _names(count: int, alike: bool) -> tuple[list[str], list[str], list[str], list[str]]:
    """mu_i, beta_i, omega_i^2 = kappa_i mu_1/mu_i and units of length rho_i/kappa_i, as texts."""
    if alike:
        return ["mu"] * count, ["beta"] * count, ["1"] * count, ["1"] * count
    rest = range(1, count)
    return (
        [f"mu{i + 1}" for i in range(count)],
        [f"beta{i + 1}" for i in range(count)],
        ["1", *(f"kappa{i + 1}*mu1/mu{i + 1}" for i in rest)],
        ["1", *(f"rho{i + 1}/kappa{i + 1}" for i in rest)],
    )


def _on_graph(
    names: Sequence[str],
    escapement: str,
    given: Record,
    platforms: Any,
    places: Sequence[Any] | None,
    spring: float,
) -> Model:
    import networkx

    nodes = list(platforms.nodes)
    where = nodes[: len(names)] if places is None else list(places)
    wrong = [p for p in where if p not in nodes]
    if wrong or len(where) != len(names):
        raise InputError(f"metronomes: places must name a node for each of {len(names)} metronomes; got {where}")
    matrix = np.eye(len(nodes)) - spring * networkx.laplacian_matrix(platforms, nodelist=nodes).toarray()
    if np.min(np.abs(np.linalg.eigvalsh(matrix))) < 0.05:
        raise InputError(
            f"metronomes: platforms joined by springs {spring} resonate with the metronomes; choose another"
        )
    response = np.linalg.inv(matrix)
    index = [nodes.index(p) for p in where]
    equations = []
    for i, q in enumerate(names):
        pull = " + ".join(f"({float(response[index[i], index[j]])!r})*{other}" for j, other in enumerate(names))
        equations.append(f"dd{q} + {q} + eps*(beta*d{q} - sigma*{q}^3 - g({q}, d{q}) + mu*({pull}))")
    return _model(names, equations, {"mu": 8, "beta": 0.8, **given}, escapement, [], False)


def _model(
    names: Sequence[str],
    equations: Sequence[str],
    parameters: Record,
    escapement: str,
    reactions: Sequence[str],
    symmetric: bool,
) -> Model:
    velocities = {q: q.replace("x", "y") for q in names}
    symmetries = {}
    if symmetric and len(names) > 1:  # exchanges of neighbours generate all
        for one, two in pairwise(names):
            pair = {one: two, two: one, velocities[one]: velocities[two], velocities[two]: velocities[one]}
            symmetries["exchange" if len(names) == 2 else f"exchange{one[1:]}{two[1:]}"] = pair
    return mechanical_model(
        "metronomes",
        names,
        equations,
        parameters={**parameters, "sigma": 0, "eps": 0.01},
        functions={"g(x, y)": escapement},
        reactions=reactions,
        velocities=velocities,
        title=f"{len(names)} metronomes on {'a movable platform' if reactions else 'movable platforms'}",
        source="Y. Kato and H. Kori, Synchronization and oscillation quenching in interacting metronomes",
        values=dict.fromkeys(names, 2),
        symmetries=symmetries,
        starts={"in-phase": {n: 2 if n in names else 0 for q in names for n in (q, velocities[q])}},
        averaging={"small": "eps", "oscillators": [{"position": q, "velocity": velocities[q]} for q in names]},
    )
