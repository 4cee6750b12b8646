"""How Sphinx builds the documentation site; `scripts/docs.py` gathers what it is built from."""

project = "Integument"
author = "the authors of Integument"
copyright = "AGPL-3.0-or-later"  # noqa: A001, Sphinx' name
extensions = ["myst_parser"]
root_doc = "index"
myst_heading_anchors = 4
myst_enable_extensions = ["deflist"]
suppress_warnings = ["myst.header"]  # README and the process pages begin sections at the level they need
html_theme = "furo"
html_title = "Integument"
html_copy_source = False
html_show_sphinx = False
html_last_updated_fmt = None
html_theme_options = {"navigation_with_keys": True}
highlight_language = "none"
pygments_style = "friendly"
pygments_dark_style = "native"
