"""The options of a picture as they are typed on the command line."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from contin.errors import InputError
from contin.plot.look import Look


def as_look(options: Mapping[str, object], x: str | None, y: Sequence[str] | None) -> Look:
    """The `Look` that --log, --limits, --labels, --size, --legend and --title ask for; InputError in words."""
    limits, labels, size = options.get("limits"), options.get("labels"), options.get("size")
    chosen: dict[str, object] = {
        "x": x, "y": list(y) if y else None, "log": tuple(_texts(options.get("log"))),
        "limits": dict(_ends(text) for text in _texts(limits)), "legend": options.get("legend") or "below",
        "title": options.get("title"),
    }  # fmt: skip
    if isinstance(labels, str):
        chosen["labels"] = False if labels == "none" else tuple(code.strip() for code in labels.split(","))
    if isinstance(size, str):
        chosen["size"] = _pair(size, "--size", "WIDTH,HEIGHT")
    return Look.of(chosen)


def _texts(value: object) -> list[str]:
    return [str(one) for one in value] if isinstance(value, list | tuple) else []


def _ends(text: str) -> tuple[str, tuple[float, float]]:
    name, sign, pair = text.partition("=")
    if not (name and sign):
        raise InputError(f"--limits: expected COLUMN=LOW,HIGH; got {text!r}")
    return name.strip(), _pair(pair, "--limits", "COLUMN=LOW,HIGH")


def _pair(text: str, option: str, form: str) -> tuple[float, float]:
    try:
        first, second = (float(part) for part in text.split(","))
    except ValueError:
        raise InputError(f"{option}: expected {form} with two numbers; got {text!r}") from None
    return first, second
