"""Type codes of special points and their normal forms in words."""

from __future__ import annotations

from contin.records import Record
from contin.special.table import special_type, table


def describe(type_: str, normal_form: Record | None = None) -> str:
    """One phrase for a point, such as 'supercritical Hopf point' or 'transcritical branch point'.

    >>> describe("BP", {"kind": "pitchfork", "criticality": "subcritical"})
    'subcritical pitchfork'
    """
    form = normal_form or {}
    noun = special_type(type_).words if type_ in table() else type_
    kind, criticality = form.get("kind"), form.get("criticality")
    kernel = form.get("kernel", 1)
    if type_ == "BP" and kernel > 1:
        return f"branch point with a {kernel}-dimensional kernel"
    if form.get("breaks"):
        return f"symmetry-breaking {noun}"
    if kind == "tangency" and type_ == "BP":
        order = form.get("contact")
        return "branch point where two branches have one tangent" + (
            "" if order is None
            else f" (contact of order {order}): they touch, without exchange of stability" if order % 2 == 0
            else f" (contact of order {order}): they cross and exchange stability"
        )  # fmt: skip
    if kind == "pitchfork":
        noun = "pitchfork" if type_ == "BP" else "pitchfork of cycles"
    elif kind == "heteroclinic":
        noun = noun.replace("homoclinic", kind)
    elif kind == "nonsmooth":
        noun = f"nonsmooth {noun}"
    elif kind:
        noun = f"{kind} {noun}"
    if criticality:
        noun = f"{criticality} {noun}"
    return f"{noun}, {form['case']}" if form.get("case") else noun
