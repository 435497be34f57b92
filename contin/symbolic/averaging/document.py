"""A derivation as a list of blocks (headings, sentences, formulas), written out as text, Markdown or LaTeX."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final, Union

from contin.model.expression import Expression
from contin.model.latex import latex_name, to_latex
from contin.model.printing import to_text

LONGEST: Final = 2000  # characters of a formula that is shown in full


@dataclass(frozen=True)
class Heading:
    """The title of a part."""

    text: str


@dataclass(frozen=True)
class Sentence:
    """Words; `maths` holds the formulas for its places {0}, {1}, ..."""

    text: str
    maths: tuple[Expression, ...] = ()


@dataclass(frozen=True)
class Formula:
    """left = right, with `left` as text and as LaTeX; nodes in `names` are written by their names."""

    left: str
    left_latex: str
    right: Expression
    names: Mapping[Expression, str] = field(default_factory=dict)


Block = Union[Heading, Sentence, Formula]


def equation_of(state: str, right: Expression, names: Mapping[Expression, str] | None = None) -> Formula:
    """state' = right"""
    return Formula(f"{state}'", rf"\dot{{{latex_name(state)}}}", right, names or {})


def as_text(blocks: Sequence[Block]) -> str:
    """Plain text for the terminal."""
    lines: list[str] = []
    for block in blocks:
        if isinstance(block, Heading):
            lines += ["", block.text, "-" * len(block.text)]
        elif isinstance(block, Sentence):
            lines.append(block.text.format(*(to_text(m) for m in block.maths)))
        else:
            lines.append(f"    {block.left} = {_cut(to_text(block.right, block.names))}")
    return "\n".join(lines).strip() + "\n"


def as_markdown(blocks: Sequence[Block]) -> str:
    """Markdown with LaTeX formulas between dollar signs."""
    parts: list[str] = []
    for block in blocks:
        if isinstance(block, Heading):
            parts.append(f"## {block.text}")
        elif isinstance(block, Sentence):
            parts.append(block.text.format(*(f"${to_latex(m)}$" for m in block.maths)))
        else:
            parts.append(f"$$\n{block.left_latex} = {_cut(to_latex(block.right, block.names))}\n$$")
    return "\n\n".join(parts) + "\n"


def as_latex(blocks: Sequence[Block], title: str) -> str:
    """A LaTeX article that compiles on its own."""
    parts = [
        r"\documentclass{article}",
        r"\usepackage{amsmath}",
        r"\begin{document}",
        rf"\title{{{_escaped(title)}}}\date{{}}\maketitle",
    ]
    formulas: list[str] = []
    for block in [*blocks, None]:
        if isinstance(block, Formula):
            formulas.append(rf"  {block.left_latex} &= {_cut(to_latex(block.right, block.names))}")
            continue
        if formulas:
            parts.append("\\begin{align*}\n" + " \\\\\n".join(formulas) + "\n\\end{align*}")
            formulas = []
        if isinstance(block, Heading):
            parts.append(rf"\section*{{{_escaped(block.text)}}}")
        elif isinstance(block, Sentence):
            parts.append(_escaped(block.text).format(*(f"${to_latex(m)}$" for m in block.maths)))
    return "\n".join([*parts, r"\end{document}"]) + "\n"


def _escaped(text: str) -> str:
    return text.replace("_", r"\_").replace("%", r"\%").replace("&", r"\&").replace("^", r"\textasciicircum ")


def _cut(text: str) -> str:
    """Quadratures are sums of hundreds of terms; their beginning shows the pattern."""
    return text if len(text) <= LONGEST else text[: LONGEST // 4] + " ... "
