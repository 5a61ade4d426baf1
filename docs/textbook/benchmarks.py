"""Outputs of benchmark runs (plain Markdown) as pages of the textbook."""

from __future__ import annotations

import re
from pathlib import Path

from textbook.rst import heading, list_table

__all__ = ["markdown_to_rst", "pages"]

_LINES = {1: "=", 2: "-", 3: "~", 4: "^"}


def pages(folder: Path) -> dict[str, str]:
    """A page for every ``*.md`` of a folder, and "index" that lists them."""
    found = sorted(folder.glob("*.md")) if folder.is_dir() else []
    made = {path.stem: _page(path) for path in found}
    return {"index": _index(list(made)), **made}


def _page(path: Path) -> str:
    text = markdown_to_rst(path.read_text(encoding="utf-8"))
    if not re.match(r"\s*[^\n]+\n=+\n", text):
        text = heading(path.stem.replace("-", " ").replace("_", " ").capitalize()) + "\n" + text
    return text


def _index(names: list[str]) -> str:
    title = heading("Benchmarks")
    if not names:
        return title + "\nNo run has been recorded yet: see ``benchmarks/``.\n"
    entries = "\n".join(f"   benchmark-{name}" for name in names)
    return (
        f"{title}\nOutputs of runs, as they were.\n\n.. toctree::\n   :maxdepth: 1\n\n{entries}\n"
    )


def markdown_to_rst(text: str) -> str:
    """Headings, tables, code blocks, lists and paragraphs; nothing else is needed."""
    made: list[str] = []
    lines = iter([*text.splitlines(), ""])
    table: list[list[str]] = []
    listed = False
    for line in lines:
        if line.startswith("|"):
            table.append([_inline(cell.strip()) for cell in line.strip().strip("|").split("|")])
            continue
        if table:
            made += ["", _table(table), ""]
            table = []
        item = re.match(r"\s*[-*] ", line)
        if item and not listed and made and made[-1]:
            made.append("")
        listed = bool(item) or (listed and line.startswith(" "))
        title = re.match(r"(#+) (.*)", line)
        if line.startswith("```"):
            made += ["", ".. code-block:: text", "", *_fenced(lines), ""]
        elif title:
            made += ["", heading(_inline(title[2]), _LINES.get(len(title[1]), "^"))]
        elif item:
            made.append("- " + _inline(line[item.end() :]))
        else:
            made.append(("  " if listed and line.strip() else "") + _inline(line.strip()))
    return "\n".join(made).strip() + "\n"


def _fenced(lines: object) -> list[str]:
    code = []
    for line in lines:  # type: ignore[attr-defined]
        if line.startswith("```"):
            break
        code.append("   " + line)
    return code


def _table(rows: list[list[str]]) -> str:
    """The second row of a Markdown table only aligns the columns."""
    head, *body = [row for i, row in enumerate(rows) if i != 1]
    width = len(head)
    return list_table(head, [(row + [""] * width)[:width] for row in body])


def _inline(text: str) -> str:
    """Code, links and characters that mean something in reStructuredText."""
    parts = re.split(r"(`[^`]+`|\[[^\]]+\]\([^)]+\)|\*\*[^*]+\*\*|(?<!\w)\*[^*\s][^*]*\*)", text)
    return "".join(_piece(part, i % 2 == 1) for i, part in enumerate(parts))


def _piece(part: str, marked: bool) -> str:
    if not marked:
        return re.sub(r"([\\*|`]|_\b|_$)", r"\\\1", part)
    if part.startswith("`"):
        return f"`{part}`"
    link = re.match(r"\[([^\]]+)\]\(([^)]+)\)", part)
    return f"`{link[1]} <{link[2]}>`__" if link else part
