# SPDX-License-Identifier: BSD-3-Clause
"""Sphinx's settings for the site that scripts/site.sh builds. The sources are the Markdown pages as they are: the
navigation and what links names of the library to its reference are added here."""
import os
import re
import xml.etree.ElementTree

from docutils import nodes
from sphinx import addnodes

ROOT = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", ".."))


def read_version():
    with open(os.path.join(ROOT, "modules/core/include/pcl_slim/version.h"), encoding="utf-8") as file:
        return re.search(r'PCL_SLIM_VERSION "(.*)"', file.read())[1]


def read_ignored():
    """What git ignores: a workspace of colcon in build/ has a link to this folder, which would be walked through again."""
    with open(os.path.join(ROOT, ".gitignore"), encoding="utf-8") as file:
        return [line.strip().strip("/") for line in file if line.strip()]


project = "pcl_slim"
version = release = read_version()
html_title = f"pcl_slim {release}"
extensions = ["myst_parser"]
myst_heading_anchors = 4  # as GitHub makes them
root_doc = "README"
include_patterns = ["README.md", "CONTRIBUTING.md", "CHANGELOG.md", "docs/*.md", "benchmarks/README.md"]
exclude_patterns = [".git", *read_ignored()]
html_theme = "furo"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_copy_source = False
html_show_copyright = False
html_show_sphinx = False
templates_path = ["templates"]
html_sidebars = {"**": ["sidebar/brand.html", "sidebar/search.html", "sidebar/scroll-start.html", "sidebar/navigation.html",
                        "api.html", "sidebar/scroll-end.html"]}
pygments_style = "default"
pygments_dark_style = "monokai"
highlight_language = "none"  # blocks without a language are commands and what they print
nitpicky = True

NAVIGATION = """
```{toctree}
:hidden:
:caption: %s

%s
```
"""


def add_navigation(app, docname, source):
    """Appends the lists of pages to the front page: hidden there, shown at the side of every page."""
    if docname != root_doc:
        return
    with open(os.path.join(ROOT, "docs/site/navigation.txt"), encoding="utf-8") as file:
        groups = re.split(r"^# (.*)\n", file.read(), flags=re.M)[1:]
    for caption, pages in zip(groups[::2], groups[1::2]):
        source[0] += NAVIGATION % (caption, pages.strip())


def reference_pages(tags):
    """Addresses in the reference of classes, functions and enumerations, by name."""
    pages = {}
    for compound in xml.etree.ElementTree.parse(tags).getroot():
        kind, name = compound.get("kind"), compound.findtext("name", "")
        if kind in ("class", "struct") and name.startswith("pcl_slim::"):
            pages[name[len("pcl_slim::"):]] = compound.findtext("filename")
        if kind not in ("namespace", "group"):
            continue
        for member in compound.iter("member"):
            if member.get("kind") in ("function", "enumeration"):
                address = f"{member.findtext('anchorfile')}#{member.findtext('anchor')}"
                pages.setdefault(member.findtext("name"), address)
    return pages


def link_names(app, doctree, docname):
    """Makes `Name` a link to the reference where Name is one of the library."""
    up = "../" * docname.count("/")
    for literal in list(doctree.findall(nodes.literal)):
        if isinstance(literal.parent, (nodes.reference, addnodes.pending_xref)):
            continue
        name = re.sub(r"^pcl_slim::|\(\)$|<\w+>$", "", literal.astext())
        page = app.reference_pages.get(name)
        if page:
            link = nodes.reference("", "", literal.deepcopy(), refuri=f"{up}api/{page}", classes=["api"])
            literal.replace_self(link)


def repair_theme(app, error):
    """Debian 12's furo has its scripts in two files, the first of which imports the second as no browser does from a disk,
    and has lost the rule for browsers that prefer the dark."""
    static = os.path.join(app.outdir, "_static")

    def change(name, function):
        with open(os.path.join(static, name), encoding="utf-8") as file:
            text = file.read()
        with open(os.path.join(static, name), "w", encoding="utf-8") as file:
            file.write(function(text))

    def join(text):
        if not text.startswith("import Gumshoe"):
            return text
        with open(os.path.join(static, "scripts/gumshoe-patched.js"), encoding="utf-8") as file:
            return file.read() + text.split("\n", 1)[1]

    def follow_browser(text):
        if "prefers-color-scheme" in text:
            return text
        colors = re.search(r'body\[data-theme="dark"\] \{(.*?)\}', text, re.S)[1]
        return f'{text}\n@media screen and (prefers-color-scheme: dark) {{\nbody:not([data-theme="light"]) {{{colors}}} }}\n'

    if error is None:
        change("scripts/furo.js", join)
        change("styles/furo.css", follow_browser)


def setup(app):
    tags = os.environ.get("PCL_SLIM_TAGS")
    app.reference_pages = reference_pages(tags) if tags else {}
    app.connect("source-read", add_navigation)
    app.connect("doctree-resolved", link_names)
    app.connect("build-finished", repair_theme)
