"""The Python reference, by sphinx: the docstrings of the module, which are plain text. index.rst names each of its parts once."""
import pathlib
import re

import febiodea
from sphinx.errors import ConfigError

project = "FEBioDEA for Python"
author = "FEBioDEA developers"
extensions = ["sphinx.ext.autodoc"]
default_role = "code"
smartquotes = False
html_theme = "alabaster"
html_theme_options = {"description": "Discrete element analysis of joint contact for FEBio models", "font_family": "sans-serif",
                      "sidebar_width": "260px", "page_width": "1200px"}
html_sidebars = {"**": ["about.html", "localtoc.html", "searchbox.html"]}
html_show_sourcelink = False
html_copy_source = False
html_show_copyright = False
autodoc_typehints = "none"
toc_object_entries = False

named = re.findall(r"^ *\.\. auto\w+:: febiodea\.(\w+)$", pathlib.Path(__file__).with_name("index.rst").read_text(), re.M)
if sorted(named) != sorted([*febiodea.__all__, "statistics"]):
    raise ConfigError(f"index.rst: not each part of febiodea is named once: {sorted(set(named) ^ {*febiodea.__all__, 'statistics'})}")


def blocks_as_they_are(app, what, name, thing, options, lines):
    """What is set in from the margin is code, or a table."""
    text = re.sub(r"\n\n(?=    )", "\n\n::\n\n", "\n".join(lines))
    text = re.sub(r"((?:^    .*\n|^\n)+?)\n::\n\n(?=    )", r"\1\n", text, flags=re.M)  # one block, though with empty lines
    lines[:] = text.split("\n")


def setup(app):
    app.connect("autodoc-process-docstring", blocks_as_they_are)
