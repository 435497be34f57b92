"""What of SBML has no equal here, by the name of its element."""

from __future__ import annotations

from typing import Final

import libsbml

from contin.errors import InputError
from contin.exchange.imported import UnsupportedError
from contin.exchange.sbml.elements import Element
from contin.exchange.sbml.events import check_events

HARMLESS: Final = frozenset({"layout", "render", "groups", "req", "annot"})  # packages that change no equation
READ: Final = frozenset({"l3v2extendedmath", "math"})  # packages of functions that are known


def check_document(document: Element, path: object) -> tuple[Element, list[str]]:
    """The model of a document, and notes; raises for what cannot be read or has no equal."""
    model = document.getModel()
    log = document.getErrorLog()
    serious = [log.getError(k) for k in range(log.getNumErrors())]
    serious = [e for e in serious if e.getSeverity() >= libsbml.LIBSBML_SEV_ERROR]
    if model is None or serious:
        said = f"line {serious[0].getLine()}: {serious[0].getShortMessage()}" if serious else "it holds no model"
        raise InputError(f"{path}: not a valid SBML file: {said}")
    return model, [*_packages(document, path), *_elements(model, path)]


def _packages(document: Element, path: object) -> list[str]:
    notes = []
    for k in range(document.getNumPlugins()):
        name = document.getPlugin(k).getPackageName()
        if name in HARMLESS or (name == "comp" and not _is_composed(document)):
            notes.append(f"the package {name} is not read")
        elif name not in READ:
            raise UnsupportedError(f"{path}: the package {name} of SBML is not supported")
    for k in range(document.getNumUnknownPackages()):
        prefix = document.getUnknownPackagePrefix(k)
        if document.getPackageRequired(document.getUnknownPackageURI(k)):
            raise UnsupportedError(f"{path}: the package {prefix} of SBML is not supported")
        notes.append(f"the package {prefix} is not read")
    return notes


def _is_composed(document: Element) -> bool:
    """True where models are put together from others, and not merely could be."""
    whole, model = document.getPlugin("comp"), document.getModel().getPlugin("comp")
    parts = whole.getNumModelDefinitions() + whole.getNumExternalModelDefinitions()
    return bool(parts or (model is not None and model.getNumSubmodels()))


def _elements(model: Element, path: object) -> list[str]:
    def refuse(element: Element, what: str) -> None:
        name = element.getIdAttribute() or element.getName()
        shown = f" {name!r}" if name else ""
        raise UnsupportedError(f"{path}: line {element.getLine()}: {what}{shown} is not supported")

    check_events(model, path)
    for rule in model.getListOfRules():
        if rule.isAlgebraic():
            refuse(rule, "<algebraicRule>")
    for reaction in model.getListOfReactions():
        if reaction.isSetFast() and reaction.getFast():
            refuse(reaction, "a fast <reaction>")
    count = model.getNumConstraints()
    return [f"{count} <constraint>s are not checked"] if count else []
