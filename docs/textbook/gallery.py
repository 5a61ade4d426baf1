"""Figures of the examples: every matplotlib figure an example has bound to a name."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from sphinx_gallery.scrapers import figure_rst

from acutance.report import save_figure

__all__ = ["scrape_figures"]

# Which panel of its figure stands for an example in the gallery: a whole figure at the size of a
# thumbnail cannot be read. The first panel stands for the others.
PANELS = {
    "plot_2_compare_methods": 1,
    "plot_3_checkerboard": 0,
    "plot_5_asymmetric_sensor": 1,
    "plot_6_geotiff_region": 2,
    "plot_7_mirrors": 1,
    "plot_8_two_resolutions": 1,
    "plot_b_scene": 1,
    "plot_c_restoration": 1,
}
MARGIN_IN = 0.08


def scrape_figures(block: Any, block_vars: dict[str, Any], gallery_conf: dict[str, Any]) -> str:
    """Save the figures a block of an example made, and give the text that shows them."""
    paths = []
    for found in block_vars["example_globals"].values():
        if isinstance(found, Figure) and not hasattr(found, "shown_in_gallery"):
            found.shown_in_gallery = True
            path = next(block_vars["image_path_iterator"])
            save_figure(found, path, dpi=110)
            paths.append(path)
            example = Path(block_vars["src_file"]).stem
            _save_thumbnail(found, example, Path(gallery_conf["src_dir"]) / "generated")
    return figure_rst(paths, gallery_conf["src_dir"])


def _save_thumbnail(figure: Figure, example: str, folder: Path) -> None:
    """One panel of a figure, as ``thumbnail-EXAMPLE.png``."""
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    panel = figure.axes[PANELS.get(example, 0)]
    box = panel.get_tightbbox(canvas.get_renderer())
    inches = box.transformed(figure.dpi_scale_trans.inverted()).padded(MARGIN_IN)
    figure.savefig(folder / f"thumbnail-{example}.png", bbox_inches=inches, dpi=110)
