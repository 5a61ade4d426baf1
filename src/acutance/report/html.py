"""An HTML page: what its sections hold, and how they become one self-contained document."""

from __future__ import annotations

import base64
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

from acutance.report.paper import figure_bytes
from acutance.report.table_text import table_latex, table_markdown

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = [
    "Headline",
    "Link",
    "Plate",
    "Section",
    "Table",
    "Verdict",
    "render_fragment",
    "render_page",
]


@dataclass(frozen=True)
class Headline:
    """One number in large type.

    Parameters
    ----------
    label : str
    value : str
    unit : str, optional
    details : tuple of str, optional
        Lines under it: its standard deviation, its interval.
    """

    label: str
    value: str
    unit: str = ""
    details: tuple[str, ...] = ()


@dataclass(frozen=True)
class Verdict:
    """The summary of the checks.

    Parameters
    ----------
    word : {"good", "usable", "doubtful", "invalid"}
        Chooses the colour, too.
    text : str
        What matters most.
    details : tuple of (str, str), optional
        What failed: a name and a sentence each.
    """

    word: Literal["good", "usable", "doubtful", "invalid"]
    text: str
    details: tuple[tuple[str, str], ...] = ()


@dataclass(frozen=True)
class Plate:
    """A figure with its caption.

    Parameters
    ----------
    source : str
        A ``data:`` address that holds the drawing itself.
    title : str
        What it shows, also for those who cannot see it.
    caption : str
    wide : bool, optional
        Takes the whole width of the page.
    """

    source: str
    title: str
    caption: str
    wide: bool = False

    @classmethod
    def of_figure(cls, figure: Figure, title: str, caption: str, *, wide: bool = False) -> Plate:
        """Draw a figure as SVG inside the page."""
        drawing = base64.b64encode(figure_bytes(figure, ".svg")).decode("ascii")
        return cls(f"data:image/svg+xml;base64,{drawing}", title, caption, wide)


@dataclass(frozen=True)
class Table:
    """Rows of text under a header.

    Parameters
    ----------
    columns : tuple of str
    rows : tuple of tuples of str
        On a page the first line of a cell is its content, further lines are smaller.
    align : str
        One letter a column: ``"l"`` text, ``"r"`` number.
    parts : int, optional
        A long table is cut into this many side by side.
    alerts : frozenset of int, optional
        Rows to be marked as failed.
    title : str, optional
    notes : tuple of str, optional
        Paragraphs that explain it.
    page_only : bool, optional
        Too long or too special for text on a terminal.
    """

    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    align: str
    parts: int = 1
    alerts: frozenset[int] = frozenset()
    title: str = ""
    notes: tuple[str, ...] = ()
    page_only: bool = False

    def pieces(self) -> list[list[tuple[tuple[list[str], ...], bool]]]:
        """The rows, cells cut into lines, with their alert, in `parts` pieces of equal length."""
        marked = [
            (tuple(cell.split("\n") for cell in row), i in self.alerts)
            for i, row in enumerate(self.rows)
        ]
        length = max(1, -(-len(marked) // self.parts))
        return [marked[i : i + length] for i in range(0, len(marked), length)]

    def to_markdown(self) -> str:
        """The table in Markdown, its title above it."""
        return table_markdown(self)

    def to_latex(self) -> str:
        """The table as a LaTeX ``tabular``."""
        return table_latex(self)


@dataclass(frozen=True)
class Link:
    """Where to read on: a text and an address relative to the page."""

    text: str
    address: str


@dataclass(frozen=True)
class Section:
    """A part of a page; whatever it does not have is left out.

    Parameters
    ----------
    title : str
    paragraphs, headlines, verdicts, plates, tables, links : tuple, optional
        In this order on the page.
    command : str, optional
        A command line.
    side_by_side : bool, optional
        The tables, in large type, left of the first plate; other plates below them.
    """

    title: str
    paragraphs: tuple[str, ...] = ()
    headlines: tuple[Headline, ...] = ()
    verdicts: tuple[Verdict, ...] = ()
    plates: tuple[Plate, ...] = ()
    tables: tuple[Table, ...] = ()
    links: tuple[Link, ...] = ()
    command: str | None = None
    side_by_side: bool = field(default=False, kw_only=True)

    @classmethod
    def of_table(cls, table: Table) -> Section:
        """A section that holds one table, under its title and notes."""
        return cls(table.title, paragraphs=table.notes, tables=(table,))


def render_page(
    title: str,
    subtitle: str,
    sections: Sequence[Section],
    facts: Mapping[str, str] | None = None,
) -> str:
    """One self-contained HTML page; every text is escaped.

    Parameters
    ----------
    title, subtitle : str
    sections : sequence of Section
    facts : mapping of str to str, optional
        What to know first, by name: the image, when it was measured.

    Returns
    -------
    str
        A whole document: style and drawings are inside, nothing is loaded from elsewhere.
    """
    return _rendered("page.html", title=title, subtitle=subtitle, sections=sections,
                     facts=facts or {})  # fmt: skip


def render_fragment(sections: Sequence[Section]) -> str:
    """The same sections as a piece of HTML with its own style, for a notebook."""
    return _rendered("fragment.html", sections=sections)


def _rendered(name: str, **content: object) -> str:
    from jinja2 import Environment, PackageLoader, StrictUndefined

    from acutance import __version__

    environment = Environment(
        loader=PackageLoader("acutance.report"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    return environment.get_template(name).render(version=__version__, **content)
