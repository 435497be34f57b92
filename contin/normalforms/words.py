"""Type codes of special points and their normal forms in words."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

WORDS: Final[Mapping[str, str]] = {
    "LP": "fold",
    "BP": "branch point",
    "HB": "Hopf point",
    "PD": "period doubling",
    "NS": "Neimark-Sacker point",
    "LPC": "fold of cycles",
    "BPC": "branch point of cycles",
    "HOM": "homoclinic orbit",
    "UZ": "user value",
    "CP": "cusp",
    "BT": "Bogdanov-Takens point",
    "GH": "generalised Hopf point",
    "ZH": "zero-Hopf point",
    "HH": "Hopf-Hopf point",
    "DP": "degenerate branch point",
    "CPC": "cusp of cycles",
    "R1": "1:1 resonance",
    "R2": "1:2 resonance",
    "R3": "1:3 resonance",
    "R4": "1:4 resonance",
    "CH": "Chenciner point",
    "GPD": "generalised period doubling",
    "LPPD": "fold-flip point",
    "LPNS": "fold Neimark-Sacker point",
    "PDNS": "flip Neimark-Sacker point",
    "NSNS": "double Neimark-Sacker point",
    "NSS": "resonant homoclinic orbit",
    "NSF": "resonant homoclinic orbit",
    "NFF": "resonant homoclinic orbit",
    "NCH": "non-central homoclinic orbit to a saddle-node",
    "SH": "Shilnikov-Hopf point",
    "OFS": "orbit flip",
    "OFU": "orbit flip",
    "IFS": "inclination flip",
    "IFU": "inclination flip",
}
CRITICALITY: Final[Mapping[str, str]] = {
    "supercritical": "the new branch takes over the stability",
    "subcritical": "the new branch is unstable beside the stable state",
    "degenerate": "the deciding coefficient is zero to its estimated error",
}


def describe(type_: str, normal_form: Mapping[str, Any] | None = None) -> str:
    """One phrase for a point, such as 'supercritical Hopf point' or 'transcritical branch point'.

    >>> describe("BP", {"kind": "pitchfork", "criticality": "subcritical"})
    'subcritical pitchfork'
    """
    form = normal_form or {}
    noun = WORDS.get(type_, type_)
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
    elif kind == "nonsmooth":
        noun = f"nonsmooth {noun}"
    elif kind:
        noun = f"{kind} {noun}"
    if criticality:
        noun = f"{criticality} {noun}"
    return f"{noun}, {form['case']}" if form.get("case") else noun
