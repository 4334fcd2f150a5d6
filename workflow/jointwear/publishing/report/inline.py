"""Put an SVG file into a page: its own identifiers, the colours of the page's theme, a text for screen readers."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ElementTree
from pathlib import Path

from markupsafe import Markup

from jointwear.files.errors import InputError
from jointwear.files.regular_files import read_text
from jointwear.publishing.figures.palette import themed
from jointwear.publishing.figures.seal import unsealed

#: Largest picture; the largest that the workflow draws has a hundredth of it. Bytes.
LARGEST = 64 << 20
_SVG = "http://www.w3.org/2000/svg"
_DROPPED = {"metadata", "title", "desc", "script", "foreignObject"}
_REFERENCE = re.compile(r"url\(#([^)]+)\)")


def _local(name: str, value: str, prefix: str) -> str:
    """Return the value of an attribute with the page's identifiers and colours; no reference leaves the page."""
    if name == "id":
        return f"{prefix}-{value}"
    if name == "href":
        return f"#{prefix}-{value[1:]}" if value.startswith("#") else ""
    value = _REFERENCE.sub(rf"url(#{prefix}-\1)", value)
    return themed(value) if name in ("style", "fill", "stroke") else value


def inline_svg(path: str | Path, prefix: str) -> Markup:
    """Return an SVG file as an element for an HTML page.

    Parameters
    ----------
    path : the file, with a ``<desc>`` that becomes the alternative text.
    prefix : put before every identifier, so that several figures fit one page.

    Raises
    ------
    InputError : if the file is missing, is not SVG, or has no description.
    """
    try:
        root = ElementTree.fromstring(unsealed(read_text(path, LARGEST), path))
    except ElementTree.ParseError as error:
        raise InputError(f"{path}: cannot be read as SVG ({error}); delete it and run again") from None
    description = root.findtext(f"{{{_SVG}}}desc")
    if not description:
        raise InputError(f"{path}: has no description; delete it and run again")
    box = re.fullmatch(r"(?:[-0-9.e]+ ){2}([0-9.]+) [0-9.]+", root.attrib.get("viewBox", ""))
    if box is None:
        raise InputError(f"{path}: has no view box of four numbers; delete it and run again")
    for parent in list(root.iter()):
        for child in list(parent):
            if child.tag.rpartition("}")[2] in _DROPPED:
                parent.remove(child)
    for element in root.iter():
        element.tag = element.tag.rpartition("}")[2]
        # HTML knows no namespaces: a plain href does what xlink:href did.
        plain = {name.rpartition("}")[2]: value for name, value in element.attrib.items()}
        element.attrib.clear()
        element.attrib.update({n: _local(n, v, prefix) for n, v in plain.items() if not n.startswith("on")})
    # A narrow figure stays narrow, so that its text is as large as elsewhere: one point is 1.55 pixels at most.
    width = float(box[1])
    for size in ("width", "height", "version"):
        root.attrib.pop(size, None)
    root.attrib.update(
        {"role": "img", "aria-label": description, "class": "plot", "style": f"--widest: {1.55 * width:.0f}px"}
    )
    return Markup(ElementTree.tostring(root, encoding="unicode", short_empty_elements=True))
