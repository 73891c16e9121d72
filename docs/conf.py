"""Sphinx configuration."""

import importlib.metadata
import os
import sys
from pathlib import Path

# The gallery compiles many small programs and runs each once; see tests/conftest.py.
if importlib.metadata.version("jaxlib").startswith("0.10."):
    os.environ.setdefault(
        "XLA_FLAGS",
        "--xla_backend_optimization_level=0 --xla_cpu_use_fusion_emitters=false "
        "--xla_cpu_opt_preset=CPU_OPT_PRESET_FAST_COMPILE",
    )

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # small matrices, beside other builds

# Programs that the tests compile too are compiled once; see there as well.
os.environ.setdefault(
    "JAX_COMPILATION_CACHE_DIR", str(Path(__file__).parents[1] / ".pytest_cache" / "programs")
)
os.environ.setdefault("JAX_COMPILATION_CACHE_MAX_SIZE", str(2 * 10**9))
os.environ.setdefault("JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS", "0.2")

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
    "sphinx_gallery.gen_gallery",
    "accessible",
    "calculator",
    "command_options",
    "fold",
    "mathml",
    "pictures",
    "published",
    "sidebar",
]
exclude_patterns = ["_build", "_extensions", "gallery", "notebooks"]  # the last two are sources
html_math_renderer = "mathml"
html_theme = "furo"
html_title = "lightflyer"
html_static_path = ["_static"]
html_css_files = ["gallery.css"]
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

sphinx_gallery_conf = {
    "examples_dirs": ["gallery", "notebooks"],
    "gallery_dirs": ["generated/gallery", "generated/notebooks"],
    "filename_pattern": r"\.py$",
    "within_subsection_order": "gallery_figures.Order",
    "abort_on_example_error": True,
    "reset_modules": ("matplotlib", "gallery_figures.take_style"),
    "image_scrapers": ("matplotlib", "gallery_figures.result_figures"),
    "image_srcset": ["2x"],
    "ignore_repr_types": "matplotlib|Figure",
    "write_computation_times": False,
    "download_all_examples": False,
    "show_signature": False,
    "show_memory": False,
    "min_reported_time": 1e3,
}
