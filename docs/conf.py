"""How Sphinx builds the documentation: Markdown pages, and the reference from docstrings."""

from palpate import __version__

project = "Palpate"
author = "The Palpate authors"
release = version = __version__

extensions = ["myst_parser", "numpydoc", "sphinx.ext.autodoc", "sphinx.ext.mathjax"]
exclude_patterns = ["_build"]
html_theme = "furo"
html_title = "Palpate"
html_show_copyright = False

myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 3

# Single backticks in docstrings name Python objects.
default_role = "py:obj"
autodoc_member_order = "bysource"
autodoc_typehints_format = "short"
autodoc_default_options = {"members": True}
# autodoc lists the members, and the class docstring the parameters.
numpydoc_show_class_members = False
numpydoc_class_members_toctree = False
