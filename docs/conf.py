"""Sphinx settings. Every warning is an error, see the Makefile."""

from __future__ import annotations

import importlib.metadata
import re
import sys
from pathlib import Path
from typing import Any

sys.path[:0] = [str(Path(__file__).resolve().parent.parent), str(Path(__file__).resolve().parent)]

project = "graph-robustness"
author = "The graph-robustness authors"
copyright = f"2026, {author}"
release = importlib.metadata.version("graph-robustness")
version = release

extensions = [
    "myst_parser",
    "sphinx.ext.apidoc",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "mathml",
    "whole_words",
    "sphinx.ext.viewcode",
    "sphinx_gallery.gen_gallery",
]
source_suffix = {".md": "markdown", ".rst": "restructuredtext"}
exclude_patterns = [
    "_build",
    "**/.*",
    "python-api/*/modules.rst",
    "gallery/*.ipynb",
    "gallery/*.py",
    "**/sg_execution_times.rst",
]
html_theme = "furo"
html_title = "graph-robustness"
html_static_path = ["_static"]
html_css_files = ["wrapped.css"]
# A summary would be fetched, which browsers refuse to pages that are opened from a folder.
html_show_search_summary = False
html_math_renderer = "mathml"

myst_enable_extensions = ["dollarmath", "deflist", "colon_fence"]
myst_heading_anchors = 3

# One page per module, written anew at every build, so that no list of modules can go stale.
apidoc_modules = [
    {
        "path": f"../{package}",
        "destination": f"python-api/{package}",
        "separate_modules": True,
        "module_first": True,
        "implicit_namespaces": False,
        "exclude_patterns": ["**/__main__.py"],
        "automodule_options": {"members", "show-inheritance"},
    }
    for package in ("robustness", "certificates")
]
autodoc_default_options = {
    # A name is documented once, in the module that defines it, however many packages re-export it.
    "ignore-module-all": True,
}
autodoc_member_order = "bysource"
autodoc_typehints = "description"
autodoc_typehints_description_target = "documented"
napoleon_google_docstring = False
napoleon_use_ivar = True

# Stories that are run at every build, in the order of their numbers; an error in one is an error of the build.
sphinx_gallery_conf = {
    "examples_dirs": "../examples/gallery",
    "gallery_dirs": "gallery",
    "filename_pattern": r"\.py$",
    "within_subsection_order": "FileNameSortKey",
    "abort_on_example_error": True,
    "download_all_examples": False,
    "show_memory": False,
    "show_signature": False,
    "min_reported_time": 3600,
    "plot_gallery": True,
    "remove_config_comments": True,
}


def escape_bars(_app: Any, _what: str, _name: str, _object: Any, _options: Any, lines: list[str]) -> None:
    """Keep ``|S|`` a cardinality: our docstrings never mean a substitution by it. Literal text stays as it is."""
    margin: int | None = None  # of the line that opened a literal block
    in_example = False
    for i, line in enumerate(lines):
        indent = len(line) - len(line.lstrip())
        in_example = line.lstrip().startswith(">>>") or (in_example and bool(line.strip()))
        if margin is not None and line.strip() and indent <= margin:
            margin = None
        if margin is None and not in_example:
            parts = re.split(r"(``.+?``)", line)
            lines[i] = "".join(part if part.startswith("``") else part.replace("|", r"\|") for part in parts)
            if line.rstrip().endswith("::"):
                margin = indent


def setup(app: Any) -> None:
    """Register what this file adds to Sphinx."""
    # After napoleon, which reads the same lines.
    app.connect("autodoc-process-docstring", escape_bars, priority=900)


# Several result types have fields of the same name (S1, M, verdict); a bare name in a docstring links to one of them.
suppress_warnings = ["ref.python"]
