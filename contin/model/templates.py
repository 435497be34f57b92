"""Formulas of large models that are written alike: parsed once, then made for every set of names.

The equations of a chain or a grid differ only in the names of states. A formula's template is its text with each state
replaced by the number of its first occurrence; two texts with one template have graphs that differ by a renaming
of symbols, because the rules by which nodes are built (`contin.model.expression`) look at the identity of symbols only.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from typing import Final

from contin.model.expression import Expression, postorder, renamed
from contin.model.parser import Operand

_WORD: Final = re.compile(r"(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?|([^\W\d]\w*)")


class Templates:
    """Remembers the formulas read so far; `states` are the names that are replaced.

    A formula with a function or definition that uses states itself (`brings_states`) has no template: a state that it
    brings along would be taken for the one of that name in the text.
    """

    def __init__(self, states: Mapping[str, Expression], brings_states: Callable[[str], bool]) -> None:
        self._states, self._brings_states = states, brings_states
        self._known: dict[str, tuple[list[Expression], dict[str, int], Operand]] = {}

    def read(self, text: str, parse: Callable[[], Operand]) -> Operand:
        """The operand that `text` spells, by `parse` where no text of its template has been read."""
        if not text.isascii():  # one name may have several spellings
            return parse()
        slots: dict[str, int] = {}
        states = self._states
        others: set[str] = set()

        def replaced(match: re.Match[str]) -> str:
            name = match[1]
            if name not in states:
                if name is not None:
                    others.add(name)
                return match[0]
            return f"\x00{slots.setdefault(name, len(slots))}\x00"

        template = _WORD.sub(replaced, text)
        if any(map(self._brings_states, others)):
            return parse()
        known = self._known.get(template)
        if known is None:
            operand = parse()
            self._known[template] = postorder([operand.node]), slots, operand
            return operand
        nodes, first, operand = known
        names = list(slots)
        node = renamed(nodes, {old: states[names[slot]] for old, slot in first.items()})
        return Operand(node, operand.condition, operand.position)
