"""The picture of a phase diagram: curves by type, points of codimension two, regions shaded and named.

A region's letter stands where it is farthest from every curve; what the letters mean is written beside the picture.
Types of curves differ in colour and in dashes.
"""

from __future__ import annotations

import re
import textwrap
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from contin.abi import Array
from contin.linalg.polygons import deepest
from contin.plot.dress import dress
from contin.plot.house_style import style
from contin.plot.labels import densify, place
from contin.plot.look import PLAIN_LOOK, Look
from contin.plot.smooth import smooth
from contin.plot.vocabulary import colour_of, dashes_of, locus_words, style_of
from contin.records import Record

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SHADES: Final = {  # from few to many stable states: equilibria (blue), orbits (sand), both (green)
    (True, False): ("#e9f0f8", "#9fc1e2"),
    (False, True): ("#fdf3e3", "#efbf78"),
    (True, True): ("#eaf5e6", "#9fcb90"),
}
APERIODIC, EMPTY = ("#f4ebf6", "#c795d4"), "#fdfdfd"  # other attractors among them (violet), and none
NAMED: Final = 1e-3  # a region with less of the box is not named
LETTER, CODE = 9.0, 7.5  # points: sizes of the names of regions and of special points
KEYS: Final = 22  # lines that explain letters, at most
WIDTH: Final = 30  # characters of such a line
TITLE: Final = 9.5  # characters of the title on an inch of the picture, beside what explains the letters
HEIGHT, MARGIN = 5.0, 0.15  # inches: of the picture, more where the explanations need it, and around these
CROWDED, BESIDE = 4, 0.04  # points of codimension two with so many others nearer (parts of the picture) have no code


def draw(
    data: Record, branches: Sequence[Record], title: str | None = None, scan: Any = None, look: Look = PLAIN_LOOK,
    ax: Axes | None = None,
) -> Any:  # fmt: skip
    """A matplotlib figure that belongs to no window; or the same in the axes `ax`, without what stands beside them.

    data : the `phase` section of the results.  branches : those of the results; the curves in `data` are drawn.
    scan : ((k, 2) points, (k,) values) of a brute-force scan, drawn beneath.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    from contin.plot.picture import picture

    curves = [b for b in branches if b["name"] in set(data["curves"])]
    look.check_columns(data["parameters"])
    with style(look.style):
        figure: Any = picture(*(look.size or (8.0, HEIGHT)), dpi=100.0) if ax is None else ax.get_figure(root=True)
        if ax is None:
            FigureCanvasAgg(figure)
        axes: Axes = figure.add_subplot() if ax is None else ax
        axes.spines[["top", "right"]].set_visible(True)
        _shade(axes, data)
        if scan is not None:
            points, values = (np.asarray(part) for part in scan)
            axes.scatter(points[:, 0], points[:, 1], c=values, s=6, cmap="Greys", alpha=0.6, linewidths=0, zorder=1)
        _curves(axes, data, curves)
        marked = _points(axes, data, curves)
        first, second = data["parameters"]
        axes.set(xlim=data["range"][first], ylim=data["range"][second])
        dress(axes, look, first, second)
        title = look.title or title
        if title:
            axes.set_title("\n".join(textwrap.wrap(title, int(TITLE * figure.get_figwidth()))), fontsize=10)
        if ax is None and look.legend != "none":
            _legends(figure, axes, data)
            if look.size is None:
                figure.set_figheight(max(HEIGHT, _height(figure)))
        figure.draw_without_rendering()  # the layout decides where there is room for names
        if look.labels:
            _names(axes, data, curves, marked)
    return figure


def _stable(region: Record) -> int:
    return int(region["stable"] + region.get("stable_orbits", 0) + region.get("aperiodic", 0))


def _shade_of(region: Record, data: Record) -> Any:
    """The colour says which kinds of states are stable; the darker, the more of them there are in this diagram."""
    from matplotlib.colors import to_rgb

    if not _stable(region):
        return EMPTY
    kinds = region["stable"] > 0, region.get("stable_orbits", 0) > 0
    pale, deep = (np.array(to_rgb(c)) for c in (APERIODIC if region.get("aperiodic", 0) else SHADES[kinds]))
    numbers = sorted({_stable(r) for r in data["regions"] if _stable(r)})
    part = numbers.index(_stable(region)) / max(len(numbers) - 1, 1)
    return tuple((1.0 - part) * pale + part * deep)


def fill_of(region: Record, data: Record) -> str:
    """The shade of a region as a colour of pages."""
    from matplotlib.colors import to_hex

    return str(to_hex(_shade_of(region, data)))


def _legends(figure: Any, axes: Axes, data: Record) -> None:
    """Types of curves and points below; what the letters of the regions mean, at the right."""
    from matplotlib.patches import Patch

    handles, labels = axes.get_legend_handles_labels()
    for columns in range(min(3, len(handles)), 0, -1):  # as many as there is room for
        below = figure.legend(
            handles, labels, loc="outside lower center", ncols=columns, frameon=False, handlelength=3.2
        )
        if columns == 1 or below.get_window_extent(figure.canvas.get_renderer()).width <= figure.bbox.width:
            break
        below.remove()
    kinds = {r["name"]: r for r in sorted(data["regions"], key=lambda r: r["area"]) if r["area"] >= NAMED}
    kinds = dict(sorted(kinds.items(), key=lambda item: (len(item[0]), item[0])))
    keys = [
        Patch(facecolor=_shade_of(r, data), edgecolor="#666666", lw=0.5, label=_explained(name, r["words"]))
        for name, r in list(kinds.items())[:KEYS]
    ]
    if len(kinds) > KEYS:
        keys.append(Patch(visible=False, label=f"and {len(kinds) - KEYS} more: see the report"))
    if keys:
        figure.legend(handles=keys, loc="outside right upper", frameon=False, fontsize=7.5, labelspacing=0.7)


def _height(figure: Any) -> float:
    """Inches in which the legend at the right ends above the one below."""
    figure.draw_without_rendering()
    return float(sum(legend.get_window_extent().height for legend in figure.legends) / figure.dpi + MARGIN)


def _explained(name: str, words: str) -> str:
    lines = [line for part in re.split(r", (?=\d|an )", words) for line in textwrap.wrap(part, WIDTH)]
    return f"{name}  " + "\n     ".join(lines)


def _shade(axes: Axes, data: Record) -> None:
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path

    for region in data["regions"]:
        rings = [np.array([*ring, ring[0]]) for ring in (region["outline"], *region["holes"])]
        codes = np.concatenate([[Path.MOVETO, *([Path.LINETO] * (len(r) - 2)), Path.CLOSEPOLY] for r in rings])
        shape = Path(np.concatenate(rings), codes)
        axes.add_patch(PathPatch(shape, facecolor=_shade_of(region, data), edgecolor="none", zorder=0))


def _curves(axes: Axes, data: Record, curves: Sequence[Record]) -> None:
    seen: set[str] = set()
    first, second = data["parameters"]
    for branch in curves:
        code = branch["locus"] or ""
        x, y = (np.asarray(branch["columns"][name], dtype=float) for name in (first, second))
        colour = colour_of(code)
        neutral = np.asarray(branch["columns"].get("neutral") or np.zeros(len(x)), bool)
        cuts = np.flatnonzero(np.diff(neutral.astype(int))) + 1
        for rows in np.split(np.arange(len(x)), cuts):
            kind = "neutral" if neutral[rows[0]] else code
            words = "neutral saddles" if neutral[rows[0]] else locus_words(code)
            joined = np.append(rows, rows[-1] + 1) if rows[-1] + 1 < len(x) else rows
            extent = tuple(hi - lo for lo, hi in (data["range"][first], data["range"][second]))
            line = {"lw": 0.8, "ls": ":"} if neutral[rows[0]] else {"lw": 1.6, "ls": dashes_of(code)}
            label = None if kind in seen else words
            axes.plot(*smooth(x[joined], y[joined], extent), color=colour, label=label, zorder=2, **line)
            seen.add(kind)


def _points(axes: Any, data: Record, curves: Sequence[Record]) -> list[tuple[str, float, float]]:
    """Mark the points of codimension two; (type, x, y) of each."""
    marked: list[tuple[str, float, float]] = []
    seen: set[str] = set()
    names = data["parameters"]
    width = [data["range"][name][1] - data["range"][name][0] for name in names]
    for branch in curves:
        for p in branch["points"]:
            x, y = (p["values"][name] for name in names)
            near = (
                abs(x - a) < 1e-6 * width[0] and abs(y - b) < 1e-6 * width[1] for t, a, b in marked if t == p["type"]
            )
            if style_of(p["type"]).quiet or any(near):
                continue
            style = style_of(p["type"])
            label = None if p["type"] in seen else f"{p['type']}: {style.words}"
            axes.plot([x], [y], style.marker, color="black", ms=5.0, mec="white", mew=0.6, ls="", label=label, zorder=4)
            seen.add(p["type"])
            marked.append((p["type"], x, y))
    return marked


def _uncrowded(marked: Sequence[tuple[str, float, float]], data: Record) -> list[tuple[str, float, float]]:
    """The points beside which there is room for a code; the marker says what the others are."""
    if not marked:
        return []
    width = np.array([np.ptp(data["range"][name]) for name in data["parameters"]])
    places = np.array([(x, y) for _, x, y in marked]) / width
    near = np.sum(np.linalg.norm(places[:, None] - places[None, :], axis=2) < BESIDE, axis=1) - 1
    return [point for point, others in zip(marked, near, strict=True) if others < CROWDED]


def _names(
    axes: Any, data: Record, curves: Sequence[Record], marked: Sequence[tuple[str, float, float]]
) -> None:
    """Letters of regions inside them, or beside a narrow one with a line to it; codes of points beside these."""
    from matplotlib.patheffects import withStroke

    pixels = axes.figure.dpi / 72.0
    halo = [withStroke(linewidth=2.2, foreground="white", alpha=0.85)]
    back, ahead = axes.transData.inverted().transform, axes.transData.transform
    first, second = data["parameters"]
    strands = [ahead(np.column_stack([b["columns"][first], b["columns"][second]]).astype(float)) for b in curves]
    obstacles = [densify(strands, 2.5 * pixels)]
    narrow: list[tuple[str, Array]] = []
    window = np.array(axes.get_window_extent().get_points(), dtype=float)
    for region in data["regions"]:
        if region["area"] < NAMED:
            continue
        rings = [ahead(np.asarray(ring, dtype=float)) for ring in (region["outline"], *region["holes"])]
        found = deepest(rings, window)
        if found is None:
            continue
        centre, depth = found
        size = np.array([0.75 * LETTER * len(region["name"]), LETTER]) * pixels
        if depth < 0.6 * size[1]:
            narrow.append((region["name"], centre))
            continue
        style = {"fontsize": LETTER, "fontweight": "bold", "color": "#333333", "path_effects": halo}
        axes.text(*back(centre), region["name"], ha="center", va="center", zorder=3, **style)
        grid = np.stack(np.meshgrid(*[np.linspace(-0.5, 0.5, 6)] * 2), axis=-1).reshape(-1, 2)
        obstacles.append(centre + np.repeat(grid * size, 3, axis=0))
    seen = window.mean(axis=0), np.ptp(window, axis=0) / 2
    marked = [m for m in _uncrowded(marked, data) if np.all(np.abs(ahead(m[1:]) - seen[0]) <= seen[1])]
    texts = [*(name for name, _ in narrow), *(code for code, _, _ in marked)]
    if not texts:
        return
    anchors = np.array([*(centre for _, centre in narrow), *(ahead((x, y)) for _, x, y in marked)], dtype=float)
    sizes = np.array([(0.7 * CODE * len(text), CODE) for text in texts]) * pixels
    frame = axes.get_window_extent()
    centres = place(anchors, sizes, np.vstack(obstacles), (frame.x0, frame.y0, frame.x1, frame.y1))
    for k, (text, anchor, at, box) in enumerate(zip(texts, anchors, centres, sizes, strict=True)):
        if not np.isfinite(at).all() or not np.isfinite(anchor).all():
            continue
        far = k < len(narrow) or np.hypot(*((at - anchor) / (box / 2 + CODE * pixels))) > 1.6
        line = {"arrowstyle": "-", "lw": 0.6, "color": "#555555", "shrinkA": 0, "shrinkB": 0}
        axes.annotate(
            text, back(anchor), xytext=back(at), ha="center", va="center", zorder=5, path_effects=halo, fontsize=CODE,
            fontweight="bold" if k < len(narrow) else "normal", arrowprops=line if far else None,
        )  # fmt: skip
