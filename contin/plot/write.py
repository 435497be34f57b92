"""From a result document to a picture file, by its ending."""

from __future__ import annotations

import io
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Final

from contin.errors import InputError
from contin.plot import manifold
from contin.plot.figure import figure, image_names
from contin.plot.house_style import style
from contin.plot.html import html_page
from contin.plot.look import PLAIN_LOOK, Look
from contin.plot.phase import draw
from contin.plot.rows import kept_in
from contin.plot.series import from_document, panels
from contin.records import Fields, Record
from contin.store.atomic import write_bytes

if TYPE_CHECKING:
    from matplotlib.figure import Figure

PICTURES: Final = (".png", ".pdf", ".svg")
PAGES: Final = (".html",)
FAST: Final = 3  # level of compression: half the time of the usual one for a tenth more bytes


def picture(
    document: Record, suffix: str, look: Look = PLAIN_LOOK, rows: Mapping[str, Fields] | None = None
) -> bytes:
    """The bytes of a picture (`.png`, `.pdf`, `.svg`) or interactive page (`.html`) of the results.

    rows : spectra and orbits of rows for the page (`contin.plot.rows.rows_of`; default: what the document keeps).
    """
    model = document["model"]
    title, periods, units = look.title or model.get("title") or model["name"], model.get("periods"), model.get("units")
    sources = from_document(document)
    if not sources:
        raise InputError("there is nothing to plot: the results hold no branch")
    manifolds = [source for source in sources if source.kind == "manifold"]
    sources = [source for source in sources if source.kind != "manifold"]
    if manifolds and suffix in PICTURES and (not sources or look.x is None):
        ups = [look.y] if isinstance(look.y, str) else list(look.y or ())
        return _drawn(manifold.figure(manifolds, title=title, axes=[look.x, *ups] if look.x else ()), suffix)
    if not sources:
        raise InputError(f"manifolds are drawn in {', '.join(PICTURES)}; an interactive page shows branches alone")
    if suffix in PAGES:
        page = html_page(
            sources, title=title, x=look.x, y=look.y, periods=periods, units=units, phase=document.get("phase"),
            rows=rows or kept_in(document),
        )
        return page.encode()
    if suffix not in PICTURES:
        raise InputError(f"pictures end in {', '.join((*PICTURES, *PAGES))}; got {suffix!r}")

    if document.get("phase") and look.x is None and look.y is None:
        return _drawn(draw(document["phase"], document["branches"], title, look=look), suffix)
    shown = panels(sources, x=look.x, y=look.y, periods=periods, units=units)
    drawing = figure(shown, look=replace(look, title=title), images=image_names(sources), periods=periods)
    return _drawn(drawing, suffix)


def _drawn(drawing: Figure, suffix: str) -> bytes:
    stream = io.BytesIO()
    with style():
        if suffix == ".png":
            drawing.savefig(stream, format="png", pil_kwargs={"compress_level": FAST})
        else:
            drawing.savefig(stream, format=suffix[1:])
    return stream.getvalue()


def write_picture(
    document: Record, path: Path, look: Look = PLAIN_LOOK, rows: Mapping[str, Fields] | None = None
) -> None:
    """Write `picture` to a file whose ending chooses the kind."""
    data = picture(document, path.suffix, look, rows)
    write_bytes(path, data)
