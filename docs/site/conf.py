"""Sphinx's settings; `build.py` beside this file calls Sphinx with them."""

import sys
from importlib import metadata
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

project = "flatrig"
release = metadata.version("flatrig")

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "references",
]
root_doc = "docs/index"
exclude_patterns = ["docs/site"]
default_role = "py:obj"
nitpicky = True

myst_heading_anchors = 3

autodoc_default_options = {"members": True, "member-order": "bysource"}
autodoc_mock_imports = ["onnx", "stable_baselines3"]
autodoc_preserve_defaults = True
autodoc_typehints = "signature"
napoleon_google_docstring = False
toc_object_entries_show_parents = "hide"
python_maximum_signature_line_length = 80

html_theme = "furo"
html_title = f"flatrig {release}"
html_static_path = ["static"]
html_css_files = ["flatrig.css"]
html_show_copyright = False
html_show_sourcelink = False
html_copy_source = False
