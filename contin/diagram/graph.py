"""The diagram as a networkx graph: one node a special point or end (whatever number of branches meet there)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from contin.diagram.identity import wrapped

if TYPE_CHECKING:
    from networkx import MultiGraph

    from contin.abi import Array
    from contin.continuation.branch import Branch

SAME_NODE = 1e-7  # distance of two points that are one node, relative to the size of each unknown on the branch


def build_graph(parameter: str, branches: Sequence[Branch]) -> MultiGraph:
    """Nodes carry `type`, `labels` (branch.label of every branch through it), `parameter` and `z`; edges `branch`,
    `rows` (first, last) and `stable` (of the piece's middle row)."""
    import networkx as nx

    graph = nx.MultiGraph(parameter=parameter)
    places: list[tuple[Any, Any, Any]] = []  # z, angle periods, node

    def node_at(z: Array, size: Array, periods: Array, type_: str, label: str | None, value: float) -> Any:
        for known, known_periods, node in places:
            alike = known.shape == z.shape and np.array_equal(known_periods, periods)
            if alike and np.all(np.abs(wrapped(known - z, periods)) < SAME_NODE * size):
                if label is not None:
                    graph.nodes[node]["labels"].append(label)
                    graph.nodes[node]["type"] = type_
                return node
        node = len(places)
        places.append((z, periods, node))
        graph.add_node(node, type=type_, labels=[label] if label else [], parameter=value, z=z)
        return node

    for branch in branches:
        unknowns, periods = _unknowns(branch)
        size = np.maximum(np.abs(unknowns).max(axis=0), 1e-3 * np.abs(unknowns).max())
        stops: list[tuple[int, Any]] = []
        for row, end in ((0, branch.ends[0]), (len(branch) - 1, branch.ends[1])):
            stops.append((row, (f"end: {end.reason}", None)))
        if branch.parent is not None:  # where it was born: it passes through that point, which is no label of its own
            stops.append((branch.start_row, ("born", None)))
        stops += [(p.index, (p.type, f"{branch.name}.{p.label}")) for p in branch.points]
        merged: dict[int, tuple[str, str | None]] = {}
        for row, (type_, label) in stops:
            if row not in merged or label is not None:
                merged[row] = (type_, label)
        rows = sorted(merged)
        nodes = [
            node_at(unknowns[row], size, periods, *merged[row], float(branch.columns[parameter][row]))
            for row in rows
        ]
        for (first, a), (last, b) in zip(
            zip(rows, nodes, strict=True), list(zip(rows, nodes, strict=True))[1:], strict=False
        ):
            stable = "stable" in branch.columns and bool(branch.columns["stable"][(first + last) // 2])
            graph.add_edge(a, b, branch=branch.name, rows=(first, last), stable=stable)
    return graph


def _unknowns(branch: Branch) -> tuple[Array, Array]:
    """Unknowns of the rows (N, m) and their periods; of a branch from a file its parameters and states."""
    if branch.problem is not None:
        return branch.z, branch.problem.angle_periods
    known = branch.described or {}
    states = [name for name in known.get("states", ()) if name in branch.columns]
    if branch.kind == "orbit":
        states = ["period", *[name for name in branch.columns if name.endswith((".min", ".max"))]]
    names = [*states, *branch.parameters]
    periods = [float(known.get("periods", {}).get(name, 0.0)) for name in names]
    return np.column_stack([np.asarray(branch.columns[name], float) for name in names]), np.array(periods)
