"""The paper figures are drawn on: size, type, colours, and saving."""

from __future__ import annotations

import io
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from acutance.arguments import require_choice, require_class, require_path, require_whole
from acutance.execution.partial_folder import named_whole_file

if TYPE_CHECKING:
    from matplotlib.figure import Figure, FigureBase, SubFigure

__all__ = [
    "FIGURE_ENDINGS",
    "INK",
    "NAME_WITH_ROOM",
    "PALETTE",
    "figure_bytes",
    "new_page",
    "save_figure",
    "split_page",
    "styled",
]

# Okabe and Ito (2008): distinct with every kind of colour vision, and in print.
BLUE, VERMILION, GREEN, ORANGE, PURPLE, SKY = (
    "#0072B2",
    "#D55E00",
    "#009E73",
    "#E69F00",
    "#CC79A7",
    "#56B4E9",
)
PALETTE = (BLUE, VERMILION, GREEN, ORANGE, PURPLE, SKY)
PLUM = "#8a3a68"
"""The purple of the palette, dark enough for thin lines and small letters."""
INK, FAINT, SHADE = "#1b2530", "#66717d", "#eceff2"

NAME_WITH_ROOM = 40
"""Characters of a file's name that have room in the title of a page 13 inches wide."""

_NOT_IN_XML = bytes(set(range(32)) - set(b"\t\n\r"))
FIGURE_ENDINGS = (".png", ".svg", ".pdf")

_STYLE: dict[Any, Any] = {
    "font.family": "DejaVu Sans",
    "font.size": 9.5,
    "axes.titlesize": 11,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    # From the title's baseline: the label of an axis at the top keeps off its descenders.
    "axes.titlepad": 10.0,
    "axes.labelsize": 9.5,
    "axes.edgecolor": FAINT,
    "axes.labelcolor": INK,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.linewidth": 0.8,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "#dfe3e8",
    "grid.linewidth": 0.6,
    "text.color": INK,
    "xtick.color": INK,
    "ytick.color": INK,
    "xtick.labelsize": 8.5,
    "ytick.labelsize": 8.5,
    "legend.fontsize": 8.5,
    "legend.frameon": False,
    "lines.linewidth": 1.8,
    # A dollar sign in a file name is a dollar sign.
    "text.parse_math": False,
    "svg.hashsalt": "acutance",
    # Journals refuse the outlines that matplotlib would embed (Type 3).
    "pdf.fonttype": 42,
    "figure.facecolor": "white",
}


@contextmanager
def styled() -> Iterator[None]:
    """Draw and save inside this, so that settings of matplotlib leak neither in nor out."""
    import matplotlib

    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        matplotlib.rcParams.update(_STYLE)
        yield


def new_page(width_in: float, height_in: float, margin_in: float = 0.12) -> Figure:
    """An empty figure with its own canvas: no windows, no global state."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure
    from matplotlib.layout_engine import ConstrainedLayoutEngine

    x, y = margin_in / width_in, margin_in / height_in
    figure = Figure(
        figsize=(width_in, height_in),
        layout=ConstrainedLayoutEngine(rect=(x, y, 1 - 2 * x, 1 - 2 * y)),
    )
    FigureCanvasAgg(figure)
    return figure


def split_page(
    page: FigureBase,
    rows: int,
    columns: int,
    *,
    widths: Sequence[float] | None = None,
    heights: Sequence[float] | None = None,
) -> list[SubFigure]:
    """Cut a page into parts that are laid out on their own, row by row."""
    parts = page.subfigures(
        rows, columns, squeeze=False, width_ratios=widths, height_ratios=heights
    )
    return list(parts.flat)


def figure_bytes(figure: Figure, ending: str, dpi: int = 150) -> bytes:
    """The figure as a file's content; `ending` is one of ``FIGURE_ENDINGS``.

    The same figure gives the same bytes: no dates are written.

    Raises
    ------
    OptionError
        If an argument is of the wrong kind, or there is no such ending.
    """
    require_class("Figure", figure=figure)
    require_choice(FIGURE_ENDINGS, ending=ending)
    require_whole(1, dpi=dpi)
    dates: dict[str, dict[str, str | None]] = {
        ".svg": {"Date": None},
        ".pdf": {"CreationDate": None},
    }
    buffer = io.BytesIO()
    with styled(), _laid_out(figure, ending, dpi):
        figure.savefig(buffer, format=ending[1:], dpi=dpi, metadata=dates.get(ending))
    content = buffer.getvalue()
    # XML has no control characters, not even escaped; names of files may.
    return content.translate(None, _NOT_IN_XML) if ending == ".svg" else content


@contextmanager
def _laid_out(figure: Figure, ending: str, dpi: int) -> Iterator[None]:
    """Lay a page out as a file of its kind has it, and no more inside.

    A page that is still to be laid out is drawn twice by matplotlib, once for nothing but that:
    a fifth of the time.
    """
    engine = figure.get_layout_engine()
    if engine is None:
        yield
        return
    from matplotlib.backend_bases import FigureCanvasBase
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.backends.backend_pdf import FigureCanvasPdf
    from matplotlib.backends.backend_svg import FigureCanvasSVG

    canvases: dict[str, type[FigureCanvasBase]] = {
        ".png": FigureCanvasAgg,
        ".svg": FigureCanvasSVG,
        ".pdf": FigureCanvasPdf,
    }
    canvas, own_dpi = figure.canvas, figure.dpi
    try:
        canvases[ending](figure)
        # Lines of vector formats are in points, whatever the pixels of their images.
        figure.dpi = dpi if ending == ".png" else 72
        engine.execute(figure)
    finally:
        figure.set_canvas(canvas)
        figure.dpi = own_dpi
    figure.set_layout_engine(None)
    try:
        yield
    finally:
        figure.set_layout_engine(engine)


def save_figure(figure: Figure, path: str | Path, dpi: int = 150) -> None:
    """Write the figure as PNG, SVG or PDF, as the file's ending says.

    A file that was there is replaced once the new one is whole.

    Raises
    ------
    OptionError
        If an argument is of the wrong kind, there is no such ending, or the file cannot be written.
    """
    require_path(path=path)
    content = figure_bytes(figure, Path(path).suffix.lower(), dpi)
    with named_whole_file(path) as part:
        part.write_bytes(content)
