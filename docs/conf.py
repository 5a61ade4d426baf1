"""How the textbook is built: everything a page shows of the code is made from the code."""

from __future__ import annotations

import sys
from pathlib import Path

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE))

from textbook import build, crossref, mathml  # noqa: E402

import acutance  # noqa: E402

project = "acutance"
author = "the acutance authors"
project_copyright = "the acutance authors"
version = release = acutance.__version__

extensions = [
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "numpydoc",
    "sphinx_gallery.gen_gallery",
]
exclude_patterns = ["_build", "examples", "benchmarks/*.md", "generated/*.inc"]
templates_path = ["_templates"]
default_role = "py:obj"
nitpicky = False

autosummary_generate = True
autodoc_member_order = "bysource"
autodoc_preserve_defaults = True
autodoc_typehints = "signature"
autodoc_typehints_format = "short"
autodoc_type_aliases = {
    name: name for name in ("ArrayLike", "Floats", "Transfer", "RoiLike", "Axis", "Orientation")
}
python_use_unqualified_type_names = True
python_maximum_signature_line_length = 88
numpydoc_show_class_members = False
numpydoc_class_members_toctree = False

sphinx_gallery_conf = {
    "examples_dirs": "examples",
    "gallery_dirs": "gallery",
    "filename_pattern": r"plot_",
    "image_scrapers": ("textbook.gallery.scrape_figures",),
    "reset_modules": (),
    "within_subsection_order": "FileNameSortKey",
    "download_all_examples": False,
    "capture_repr": (),
    "show_memory": False,
    "min_reported_time": 10_000,
    "remove_config_comments": True,
    "log_level": {"backreference_missing": "info"},
}

html_theme = "alabaster"
html_title = f"acutance {version}"
html_static_path = ["_static"]
html_css_files = ["textbook.css"]
html_math_renderer = "mathml"
html_copy_source = False
html_show_sourcelink = False
html_sidebars = {"**": ["about.html", "searchfield.html", "navigation.html"]}
html_theme_options = {
    "description": "Spatial quality of imaging sensors in orbit",
    "page_width": "1180px",
    "body_max_width": "920px",
    "sidebar_width": "230px",
    "fixed_sidebar": True,
    "font_family": "system-ui, 'Segoe UI', Roboto, 'Helvetica Neue', sans-serif",
    "head_font_family": "system-ui, 'Segoe UI', Roboto, 'Helvetica Neue', sans-serif",
    "font_size": "16px",
    "show_powered_by": False,
    "show_relbars": True,
}


def setup(app):
    mathml.setup(app)
    crossref.setup(app)
    app.connect("config-inited", lambda app, config: build.write_all(HERE / "generated"))
