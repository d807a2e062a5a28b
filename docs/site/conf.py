# SPDX-License-Identifier: GPL-3.0-or-later
"""The site of the documents: ./run docs copies them to build/docs/source and calls sphinx-build with this file."""
import pathlib
import re

project = "todbench"
extensions = ["myst_parser"]
source_suffix = {".md": "markdown"}
exclude_patterns = ["site/*", "api/*"]
myst_heading_anchors = 4
html_theme = "furo"
html_title = "todbench"
html_copy_source = False
html_show_copyright = False
html_extra_path = ["extra"]  # the pages of the interfaces and the example files


def without_links_to_folders(app, name, source):
    """A page of the site cannot link to a folder: its name stays as text."""
    here = pathlib.Path(app.srcdir, name).parent

    def shown(link):
        return link.group(1) if (here / link.group(2)).is_dir() else link.group(0)

    source[0] = re.sub(r"\[([^\]]+)\]\(([^)#:]+)\)", shown, source[0])


def setup(app):
    app.connect("source-read", without_links_to_folders)
