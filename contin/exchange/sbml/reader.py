"""SBML text -> a model document.

Each species, parameter, compartment and species reference becomes a state (it has a rate rule, or reactions change
it), a parameter (nothing changes it) or a definition (a rule determines it). All are observed under their own names,
and `amount_S` and `concentration_S` for every species S. Of a species in a compartment whose size changes, the amount
is the state. Specification: Hucka et al., The Systems Biology Markup Language: Language Specification for Level 3
Version 2 Core (2019).
"""

from __future__ import annotations

from pathlib import Path

import libsbml

from contin.exchange.imported import Imported
from contin.exchange.sbml.assembly import Assembly
from contin.exchange.sbml.refusals import check_document


def read(text: str, path: Path) -> Imported:
    """The model in an SBML text whose XML has been checked."""
    model, notes = check_document(libsbml.readSBMLFromString(text), path)
    return Imported(Assembly(model, path, notes).document(), tuple(notes))
