"""The options of a picture as they are typed on the command line."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from contin.errors import InputError
from contin.plot.look import Look
from contin.records import Fields


def as_look(options: Mapping[str, object], x: str | None, y: Sequence[str] | None) -> Look:
    """The `Look` that --log, --limits, --labels, --size, --legend and --title ask for; InputError in words."""
    return Look.of(written_look(options, x, y))


def written_look(options: Mapping[str, object], x: str | None, y: Sequence[str] | None) -> Fields:
    """What was typed of these, as run files hold it; InputError where it is no such thing."""
    labels, size, legend = options.get("labels"), options.get("size"), options.get("legend")
    chosen: Fields = {"x": x, "y": list(y) if y else None, "title": options.get("title")}
    chosen["limits"] = dict(_ends(text) for text in _texts(options.get("limits")))
    chosen["log"] = tuple(_texts(options.get("log")))
    if isinstance(labels, str):
        chosen["labels"] = False if labels == "none" else tuple(code.strip() for code in labels.split(","))
    if isinstance(size, str):
        chosen["size"] = _pair(size, "--size", "WIDTH,HEIGHT")
    if legend not in (None, "below"):
        chosen["legend"] = legend
    written = {key: value for key, value in chosen.items() if value not in (None, (), {})}
    Look.of(written)
    return written


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
