"""`plot:` of a run file as a mapping: the file and what `contin.plot.look.Look` knows."""

from __future__ import annotations

from typing import Annotated, Final, Literal

from pydantic import AfterValidator, Discriminator, Field, Tag

from contin.model.schema import Text
from contin.records import Fields
from contin.runs.entry_types import File, Interval, Section, Texts, mapping_or_not, wrong

SAFE: Final = (
    "font.", "axes.", "lines.", "xtick.", "ytick.", "legend.", "grid.", "figure.facecolor", "figure.dpi",
    "savefig.dpi", "savefig.transparent", "mathtext.fontset",
)  # fmt: skip
"""rcParams that a file may set: those that only change the look, never how text is made or which program runs."""


def _safe(style: dict[str, str | float | bool]) -> dict[str, str | float | bool]:
    for name in style:
        if not name.startswith(SAFE):
            raise wrong(f"style: a file may not set {name!r}; it may set {', '.join(part + '*' for part in SAFE[:7])}")
    return style


class PictureEntry(Section):
    """The picture of a run: where it goes and how it looks."""

    file: File
    x: Text | None = None
    y: Texts | None = None
    labels: bool | list[Text] = True
    limits: dict[str, Interval] = {}
    log: Texts = Field(default_factory=list, validate_default=False)
    size: Annotated[list[float], Field(min_length=2, max_length=2)] | None = None
    legend: Literal["below", "inside", "none"] | bool = "below"
    title: Text | None = None
    style: Annotated[dict[str, str | float | bool], AfterValidator(_safe)] = {}

    def look(self) -> dict[str, object]:
        """The options that were written, as `Look.of` takes them."""
        return self.model_dump(exclude={"file"}, exclude_unset=True)


Picture = Annotated[
    Annotated[File, Tag("(short)")] | Annotated[PictureEntry, Tag("(long)")], Discriminator(mapping_or_not)
]


def file_of(picture: str | PictureEntry | None) -> str | None:
    """The picture's file, however it was written."""
    return picture.file if isinstance(picture, PictureEntry) else picture


def look_of(picture: str | PictureEntry | None, **axes: object) -> Fields:
    """What is said of it, over the axes that are written beside it, as `Look.of` takes it."""
    said = picture.look() if isinstance(picture, PictureEntry) else {}
    return {**{key: value for key, value in axes.items() if value is not None}, **said}
