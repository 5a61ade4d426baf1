"""Tables as text for papers and notebooks: Markdown and LaTeX."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from acutance.report.html import Table

__all__ = ["table_latex", "table_markdown"]

_LATEX: Final = {
    "\\": r"\textbackslash{}", "&": r"\&", "%": r"\%", "$": r"\$", "#": r"\#", "_": r"\_",
    "{": r"\{", "}": r"\}", "~": r"\textasciitilde{}", "^": r"\textasciicircum{}",
    "<": r"$<$", ">": r"$>$", "±": r"$\pm$", "…": r"\ldots{}", "–": "--", "−": r"$-$",
    "°": r"$^\circ$", "²": r"$^2$", "×": r"$\times$", "σ": r"$\sigma$", "≥": r"$\geq$",
    "→": r"$\to$",
}  # fmt: skip
"""Characters that mean something else to LaTeX, or that its fonts lack."""
_ALIGN: Final = {"l": ":---", "r": "---:"}


def table_markdown(table: Table) -> str:
    """A table in Markdown, its title above it.

    Parameters
    ----------
    table : Table
    """
    lines = [table.columns, [_ALIGN[one] for one in table.align], *map(_cells, table.rows)]
    title = [f"**{table.title}**", ""] if table.title else []
    return "\n".join([*title, *(f"| {' | '.join(map(_in_pipes, line))} |" for line in lines)])


def table_latex(table: Table) -> str:
    r"""A table as a LaTeX ``tabular``; it needs no package.

    Parameters
    ----------
    table : Table
    """
    lines = [rf"{' & '.join(map(_in_latex, cells))} \\" for cells in map(_cells, table.rows)]
    head = rf"{' & '.join(map(_in_latex, table.columns))} \\"
    begin = rf"\begin{{tabular}}{{{table.align}}}"
    return "\n".join([begin, r"\hline", head, r"\hline", *lines, r"\hline", r"\end{tabular}"])


def _cells(row: tuple[str, ...]) -> list[str]:
    """The content of a row; further lines of a cell explain it on a page."""
    return [cell.partition("\n")[0] for cell in row]


def _in_pipes(cell: str) -> str:
    return cell.replace("|", "\\|")


def _in_latex(cell: str) -> str:
    return "".join(_LATEX.get(one, one) for one in cell)
