# SPDX-License-Identifier: BSD-3-Clause
"""Follows every link of a built site (scripts/site.sh) to its file and its anchor.

    python3 tests/site_test.py SITE ROOT    prints each link that leads nowhere and each page that names ROOT, the folder
                                            of the sources; exits 1 if there is one
"""
import html.parser
import os
import sys
from urllib.parse import unquote, urlsplit

# What a page of each kind must have: a site without them passes no test of links.
EXPECTED = ("index.html", "README.html", "search.html", "searchindex.js", "docs/slim_fit.html", "api/index.html",
            "api/classpcl__slim_1_1SLIMFit.html", "api/classpcl__slim_1_1SurfaceProbe.html", "api/group__mesh.html")


class Page(html.parser.HTMLParser):
    """The anchors of a page, and the addresses that it names."""

    def __init__(self, path):
        super().__init__()
        self.anchors, self.links = set(), []
        with open(path, encoding="utf-8") as file:
            self.text = file.read()
        self.feed(self.text)

    def handle_starttag(self, tag, attributes):
        for name, value in attributes:
            if name == "id" or name == "name" and tag == "a":
                self.anchors.add(value)
            elif name in ("href", "src") and value:
                self.links.append(value)


def main():
    if len(sys.argv) != 3:
        sys.exit("usage: python3 tests/site_test.py SITE ROOT")
    site, root = (os.path.abspath(path) for path in sys.argv[1:])
    defects = [f"{name} is missing" for name in EXPECTED if not os.path.exists(os.path.join(site, name))]
    paths = [os.path.join(folder, name) for folder, _, names in os.walk(site) for name in names if name.endswith(".html")]
    pages = {path: Page(path) for path in paths}
    count = 0
    for path, page in pages.items():
        if root in page.text:
            defects.append(f"{os.path.relpath(path, site)} names {root}")
        for link in page.links:
            parts = urlsplit(link)
            if parts.scheme or parts.netloc or link == "#":
                continue
            count += 1
            target = os.path.normpath(os.path.join(os.path.dirname(path), unquote(parts.path))) if parts.path else path
            if not os.path.exists(target) or not target.startswith(site):
                defects.append(f"{os.path.relpath(path, site)}: {link} leads to no file of the site")
            elif parts.fragment and target in pages and unquote(parts.fragment) not in pages[target].anchors:
                defects.append(f"{os.path.relpath(path, site)}: {link} leads to no anchor")
    print("\n".join(defects + [f"{count} links of {len(pages)} pages, {len(defects)} defects"]))
    sys.exit(bool(defects))


main()
