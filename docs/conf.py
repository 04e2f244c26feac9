"""Settings of the documentation site: `sphinx-build -W docs build/docs` writes static files."""

import sys
from pathlib import Path

import drystone

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE / "extensions"))

project = "drystone"
author = "The drystone developers"
project_copyright = "The drystone developers"
release = version = drystone.__version__
language = "en"

extensions = [
    "myst_parser",  # the pages are Markdown, so that they can be read without building them
    "sphinx.ext.autodoc",  # the API page is made of docstrings
    "sphinx.ext.napoleon",  # docstrings have sections as numpy's do
    "sphinx.ext.viewcode",
    "declared",  # ours: keys of model files and commands, as the program declares them
    "gallery",  # ours: a picture of every example
]
exclude_patterns = ["extensions", "images", "**/.*"]

myst_enable_extensions = ["deflist", "colon_fence", "attrs_inline"]
myst_heading_anchors = 4  # links to headings, as forges know them
suppress_warnings = ["myst.header"]  # builders' tables and generated pages skip a level

autodoc_member_order = "bysource"
autodoc_typehints = "none"  # the signature of a setting is its line of unit and meaning
autodoc_class_signature = "separated"
napoleon_google_docstring = False
napoleon_use_rtype = False
default_role = "code"

html_theme = "furo"
html_title = "drystone"
html_theme_options = {"source_directory": "docs/"}
html_copy_source = False
html_show_sphinx = False

# `sphinx-build -b linkcheck docs build/links` asks for every address of the web (howto/release.md).
linkcheck_timeout = 20  # s
linkcheck_retries = 2
linkcheck_rate_limit_timeout = 60  # s: a server that asks to wait longer is reported
linkcheck_anchors = False  # pages that scripts write have their anchors in no file
