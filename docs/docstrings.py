"""The docstrings of contin as reStructuredText: paragraphs, `names`, lists "name : meaning", sections, examples."""

from __future__ import annotations

import re

ITEM = re.compile(r"^([\w*][\w*, .]*) : (.*)$")
UNDERLINE = re.compile(r"^(-{3,})$")
SPECIAL = re.compile(r"([\\*|_<>])")


def as_restructured_text(text: str) -> str:
    """Nothing in a docstring is markup except `names`; everything else is shown as it is written."""
    out: list[str] = []
    for block in re.split(r"\n[ \t]*\n", text.strip("\n")):
        out += [*_block(block.split("\n")), ""]
    return "\n".join(out)


def _block(lines: list[str]) -> list[str]:
    if len(lines) > 1 and UNDERLINE.match(lines[1].strip()):  # a section of numpy's style
        rest = [line.strip() for line in lines[2:]]
        names = [line for line, raw in zip(rest, lines[2:], strict=True) if not raw.startswith(" ")]
        return [f".. rubric:: {lines[0].strip()}", "", *_terms(rest, names)]
    if lines[0].lstrip().startswith(">>>") or all(line.startswith("    ") for line in lines):
        return ["::", "", *(f"    {line}" for line in lines)]
    if any(ITEM.match(line) for line in lines):
        return _items(lines)
    return [_inline(" ".join(line.strip() for line in lines))]


def _items(lines: list[str]) -> list[str]:
    """A paragraph that may turn into a list of parameters."""
    items: list[tuple[str, list[str]]] = [("", [])]
    for line in lines:
        match = ITEM.match(line)
        if match:
            items.append((match[1], [match[2]]))
        else:
            items[-1][1].append(line.strip())
    out = [_inline(" ".join(items[0][1])), ""] if items[0][1] else []
    for name, words in items[1:]:
        out += [f"``{name.strip()}``", f"    {_inline(' '.join(words))}", ""]
    return out


def _terms(lines: list[str], names: list[str]) -> list[str]:
    out: list[str] = []
    for line in lines:
        out += ["", f"``{line}``"] if line in names else [f"    {_inline(line)}"]
    return [*out, ""]


def _inline(text: str) -> str:
    """`names` become literals; what would be markup elsewhere is escaped."""
    parts = text.split("`")
    if len(parts) % 2 == 0:
        return SPECIAL.sub(r"\\\1", text).replace("`", r"\`")
    done = [
        SPECIAL.sub(r"\\\1", part) if k % 2 == 0 else f"``{part}``"
        for k, part in enumerate(parts)
        if part or k % 2 == 0
    ]
    joined = done[0]
    for part in done[1:]:  # a literal ends where a blank or "\ " follows
        glue = (
            ""
            if not joined or joined[-1] in " (['" or part[:1] in (" ", ".", ",", ";", ":", ")", "]", "'", "")
            else r"\ "
        )
        joined += glue + part
    return joined
