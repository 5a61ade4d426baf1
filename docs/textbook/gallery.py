"""Figures of the examples: every matplotlib figure an example has bound to a name."""

from __future__ import annotations

from typing import Any

from matplotlib.figure import Figure
from sphinx_gallery.scrapers import figure_rst

from acutance.report import save_figure

__all__ = ["scrape_figures"]


def scrape_figures(block: Any, block_vars: dict[str, Any], gallery_conf: dict[str, Any]) -> str:
    """Save the figures a block of an example made, and give the text that shows them."""
    paths = []
    for found in block_vars["example_globals"].values():
        if isinstance(found, Figure) and not hasattr(found, "shown_in_gallery"):
            found.shown_in_gallery = True
            path = next(block_vars["image_path_iterator"])
            save_figure(found, path, dpi=110)
            paths.append(path)
    return figure_rst(paths, gallery_conf["src_dir"])
