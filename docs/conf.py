"""Configuration of the site; built by `scripts/docs`."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import swgpar

EXTENSIONS = str(Path(__file__).parent / "_extensions")
sys.path.insert(0, EXTENSIONS)
# for the processes that run the gallery
os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, [EXTENSIONS, os.environ.get("PYTHONPATH")]))
os.environ.setdefault("PYVISTA_OFF_SCREEN", "true")

project = "swgpar"
author = "the swgpar developers"
version = release = swgpar.__version__
html_title = "swgpar"
html_theme = "furo"
html_static_path = ["_static"]
html_css_files = ["swgpar.css"]
smartquotes = False
html_show_sphinx = False
html_show_copyright = False

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.mathjax",
    "sphinx.ext.napoleon",
    "sphinx.ext.viewcode",
    "property_texts",
    "sphinx_design",
    "sphinx_gallery.gen_gallery",
    "gallery_hooks",
    "sphinx-mathjax-offline",  # equations without a network
]
# equations and figures have the number of their page, so that other pages can refer to them
numfig = True
numfig_secnum_depth = 1
source_suffix = {".md": "markdown", ".rst": "restructuredtext"}
exclude_patterns = [
    "_build",
    "_extensions",
    "_generated",
    "drawings",
    "generators",
    "gallery",
    "auto_gallery/*.py",
    "auto_gallery/*.ipynb",
]
suppress_warnings = ["toc.empty_glob", "config.cache"]

myst_enable_extensions = [
    "amsmath",
    "attrs_inline",
    "colon_fence",
    "deflist",
    "dollarmath",
    "tasklist",
]
myst_heading_anchors = 3

autodoc_typehints = "description"
autodoc_preserve_defaults = True  # a communicator has no text of its own
autodoc_typehints_description_target = "documented_params"
autodoc_member_order = "bysource"
napoleon_google_docstring = False
napoleon_use_rtype = False

sphinx_gallery_conf = {
    "examples_dirs": "gallery",
    "gallery_dirs": "auto_gallery",
    "filename_pattern": r"/plot_",
    "within_subsection_order": "gallery_hooks.PageOrder",
    "reset_modules": ("matplotlib", "gallery_hooks.name_the_file"),
    "parallel": 2,
    "remove_config_comments": True,
    "download_all_examples": False,
    "show_memory": False,
    "show_signature": False,
    "min_reported_time": 1,
    "capture_repr": (),
    "abort_on_example_error": True,
}
