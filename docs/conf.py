"""Sphinx configuration."""

import sys
from pathlib import Path

import lightflyer

sys.path.insert(0, str(Path(__file__).parent / "_extensions"))

project = "lightflyer"
author = "The lightflyer developers"
project_copyright = "2026, the lightflyer developers"
version = release = lightflyer.__version__

extensions = [
    "myst_parser",
    "numpydoc",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "calculator",
    "mathml",
]
exclude_patterns = ["_build", "_extensions"]
html_math_renderer = "mathml"
html_theme = "furo"
html_title = "lightflyer"
myst_enable_extensions = ["dollarmath", "deflist", "colon_fence"]
myst_heading_anchors = 3

autosummary_generate = True
autodoc_typehints = "none"
autodoc_default_options = {"members": True, "show-inheritance": True}
numpydoc_show_class_members = False
numpydoc_xref_param_type = False
# citations stand once, on the page of references
numpydoc_citation_re = r"[A-Z][A-Za-z]+\d{4}[a-z]?"
nitpicky = False
# Markdown pages cite by a link to the page of references, which Sphinx does not count
suppress_warnings = ["ref.citation"]
