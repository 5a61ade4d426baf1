"""An HTML report: what its sections hold, and how they become one self-contained page.

A method adds to the report by returning `Section` objects; the template knows nothing of methods.
"""

from __future__ import annotations

import base64
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from acutance.report.page import figure_bytes

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["Headline", "Link", "Plate", "Section", "Table", "Verdict", "render_report"]


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
    """What the checks say, in a sentence."""

    passed: bool
    text: str


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
    align : str
        One letter a column: ``"l"`` text, ``"r"`` number.
    parts : int, optional
        A long table is cut into this many side by side.
    alerts : frozenset of int, optional
        Rows to be marked as failed.
    """

    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    align: str
    parts: int = 1
    alerts: frozenset[int] = frozenset()

    def pieces(self) -> list[list[tuple[tuple[str, ...], bool]]]:
        """The rows with their alert, in `parts` pieces of equal length."""
        marked = [(row, i in self.alerts) for i, row in enumerate(self.rows)]
        length = max(1, -(-len(marked) // self.parts))
        return [marked[i : i + length] for i in range(0, len(marked), length)]


@dataclass(frozen=True)
class Link:
    """Where to read on: a text and an address relative to the page."""

    text: str
    address: str


@dataclass(frozen=True)
class Section:
    """A part of a report; whatever it does not have is left out of the page."""

    title: str
    paragraphs: tuple[str, ...] = ()
    headlines: tuple[Headline, ...] = ()
    verdicts: tuple[Verdict, ...] = ()
    plates: tuple[Plate, ...] = ()
    tables: tuple[Table, ...] = ()
    links: tuple[Link, ...] = ()
    command: str | None = None


def render_report(title: str, subtitle: str, sections: Sequence[Section]) -> str:
    """One self-contained HTML page; every text is escaped.

    Parameters
    ----------
    title, subtitle : str
    sections : sequence of Section

    Returns
    -------
    str
        A whole document: style and drawings are inside, nothing is loaded from elsewhere.
    """
    from jinja2 import Environment, PackageLoader, StrictUndefined

    from acutance import __version__

    environment = Environment(
        loader=PackageLoader("acutance.report"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    template = environment.get_template("report.html")
    return template.render(title=title, subtitle=subtitle, sections=sections, version=__version__)
