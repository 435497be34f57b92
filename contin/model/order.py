"""The order in which named things that use each other can be worked out."""

from __future__ import annotations

from collections.abc import Iterable, Mapping


class CircleError(ValueError):
    """Some names need each other; `circle` lists them, the first one repeated at the end."""

    def __init__(self, circle: list[str]) -> None:
        super().__init__(" -> ".join(circle))
        self.circle = circle


def dependency_order(needs: Mapping[str, Iterable[str]]) -> list[str]:
    """Every key of `needs` after all keys it needs; without recursion, so a chain may be long."""
    order: list[str] = []
    done: set[str] = set()
    for root in needs:
        if root in done:
            continue
        open_names = {root: None}  # the chain from the root, in order
        iterators = [iter(needs[root])]
        while iterators:
            for name in iterators[-1]:
                if name in open_names:
                    chain = list(open_names)
                    raise CircleError([*chain[chain.index(name) :], name])
                if name in needs and name not in done:
                    open_names[name] = None
                    iterators.append(iter(needs[name]))
                    break
            else:
                iterators.pop()
                finished, _ = open_names.popitem()
                done.add(finished)
                order.append(finished)
    return order
