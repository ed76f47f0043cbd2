"""Reads the data of a page of results, independently of the program: base64, zlib, JSON."""

import base64
import json
import re
import zlib
from html.parser import HTMLParser


def data_of(page):
    """Returns the data of a page (text of report.html) as Python objects."""
    found = re.search(r'<script type="application/zlib" id="data">([^<]*)</script>', page)
    return json.loads(zlib.decompress(base64.b64decode(found.group(1))))


class _References(HTMLParser):
    """Collects all attributes by which a page can refer to other files."""

    NAMES = {"src", "href", "xlink:href", "srcset", "data", "action", "poster", "background"}

    def __init__(self):
        super().__init__()
        self.found = []

    def handle_starttag(self, tag, attributes):
        self.found += [(tag, name, value) for name, value in attributes if name in self.NAMES]


def references_of(page):
    """Returns (tag, attribute, value) of everything in a page that can refer to another file."""
    reader = _References()
    reader.feed(page)
    return reader.found
