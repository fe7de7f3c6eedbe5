"""The docs as a site: `make site`, which asks nothing of the network."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent / "site"))

from jupyter_client.manager import KernelManager

import octsim

# what notebooks tell their kernel is encrypted where it can be, which by default it is not
KernelManager.transport_encryption.default_value = "auto"

# stages are shown as the functions that they are, with their arguments
for name in octsim.__dir__():
    if stage := getattr(getattr(octsim, name), "__wrapped__", None):
        setattr(octsim, name, stage)

project = "octsim"
author = "The octsim developers"
copyright = author  # noqa: A001 (Sphinx's name)
version = release = octsim.__version__
extensions = [
    "myst_nb", "numpydoc", "sphinx.ext.autodoc", "sphinx.ext.autosummary",
    "mathml", "command_help",
]  # fmt: skip
exclude_patterns = ["_site", "site", "jupyter_execute"]
# notebooks are run at each build, which stops where a cell does; none takes a minute
nb_execution_mode = "force"
nb_execution_raise_on_error = True
nb_execution_timeout = 300
# in a folder of their own, as they write files
nb_execution_in_temp = True
# GitHub's own anchors of headings, which the pages link to
myst_heading_anchors = 3
html_math_renderer = "mathml"
html_theme = "pydata_sphinx_theme"
html_theme_options = {
    "logo": {"text": f"octsim {octsim.__version__}"},
    "header_links_before_dropdown": 4,
    "navigation_with_keys": False,
    "secondary_sidebar_items": ["page-toc"],
}
html_show_sourcelink = False
# of a class, what it is: a config's keys have a page of their own
numpydoc_show_class_members = False
autodoc_typehints = "none"
