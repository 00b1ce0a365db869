"""Figures as SVG that stands within a page: vectors and words, ids of its own, nothing from outside."""

import base64
import io
import re
from collections.abc import Container
from xml.etree import ElementTree

import numpy as np
from matplotlib import rc_context
from matplotlib.artist import Artist
from matplotlib.collections import Collection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from PIL import Image

from studies.markup import legible

SVG, XLINK = "http://www.w3.org/2000/svg", "http://www.w3.org/1999/xlink"

HREF = f"{{{XLINK}}}href"

PNG = "data:image/png;base64,"

MANY = 2_000
"""Points from which on a line or a collection is drawn as pixels."""

RASTER = 120
"""Pixels an inch of what is drawn as pixels."""

LEAST = 0.75
"""How far a figure shrinks on a narrow screen."""

REFERENCE = re.compile(r"^(?:url\()?#([^)]+)\)?$")
"""What names another element by its id."""

PLACES = ("d", "x", "y", "width", "height")
"""Attributes of places."""

HUNDREDTHS = re.compile(r"(\.\d\d)\d+")


def inline_svg(figure: Figure, prefix: str, title: str) -> str:
    """A figure as an `svg` element, the same for the same figure.

    Words stay words. What has many points becomes pixels, which are marked so in the figure.

    Parameters
    ----------
    figure
        The figure.
    prefix
        Stands before all ids, which have to be unique in a page.
    title
        What it shows, for those who do not see it.
    """
    for artist in figure.findobj(_has_many_points):
        artist.set_rasterized(True)
    drawn = io.BytesIO()
    with rc_context({"svg.hashsalt": prefix, "svg.fonttype": "none"}):
        figure.savefig(drawn, format="svg", dpi=RASTER, metadata={"Date": None})
    root = ElementTree.fromstring(legible(drawn.getvalue().decode("utf-8")))
    for parent in list(root.iter()):
        _drop(parent, "metadata")
        # Of matplotlib's own, for all of the page; as attributes of the root they do the same.
        _drop(parent, "style")
    used = {name for element in root.iter() for value in element.attrib.values() for name in REFERENCE.findall(value)}
    for element in root.iter():
        if element.tag == f"{{{SVG}}}image":
            element.attrib[HREF] = _with_palette(element.attrib[HREF])
        _shorten(element)
        _rename(element, prefix, used)
    width = float(root.attrib.pop("width").removesuffix("pt")) * 96 / 72
    del root.attrib["height"]
    root.attrib.pop("version", None)
    root.attrib |= {
        "role": "img",
        "aria-label": title,
        "stroke-linejoin": "round",
        "stroke-linecap": "butt",
        "style": f"max-width: {width:.0f}px; min-width: {min(LEAST * width, width):.0f}px",
    }
    ElementTree.register_namespace("", SVG)
    ElementTree.register_namespace("xlink", XLINK)
    return ElementTree.tostring(root, encoding="unicode")


def _has_many_points(artist: Artist) -> bool:
    points = 0
    if isinstance(artist, Line2D):
        points = np.size(artist.get_xdata())
    elif isinstance(artist, Collection):
        points = max(sum(len(np.asarray(p.vertices)) for p in artist.get_paths()), np.shape(artist.get_offsets())[0])
    return points > MANY


def _drop(parent: ElementTree.Element, name: str) -> None:
    for child in parent.findall(f"{{{SVG}}}{name}"):
        parent.remove(child)


def _with_palette(address: str) -> str:
    """The same pixels in a fraction of the bytes, where they have few colours, as maps do."""
    with Image.open(io.BytesIO(base64.b64decode(address.removeprefix(PNG)))) as image:
        pixels = np.asarray(image.convert("RGBA"))
    colours, index = np.unique(np.ascontiguousarray(pixels).view(np.uint32), return_inverse=True)
    if len(colours) > 256:
        return address
    few = Image.fromarray(index.astype(np.uint8).reshape(pixels.shape[:2]))
    few.putpalette(colours.view(np.uint8).tobytes(), "RGBA")
    written = io.BytesIO()
    few.save(written, "PNG", optimize=True)
    return PNG + base64.b64encode(written.getvalue()).decode()


def _shorten(element: ElementTree.Element) -> None:
    """Leave out blanks between elements, and what lies below a hundredth of a point."""
    for place in ("text", "tail"):
        if not (getattr(element, place) or "").strip():
            setattr(element, place, None)
    for key in PLACES:
        if key in element.attrib:
            element.attrib[key] = HUNDREDTHS.sub(r"\1", " ".join(element.attrib[key].split()))


def _rename(element: ElementTree.Element, prefix: str, used: Container[str]) -> None:
    """Put the prefix before the id of an element and of those that it refers to; leave out ids that nothing uses."""
    if element.attrib.get("id") not in used:
        element.attrib.pop("id", None)
    for key, value in element.attrib.items():
        if key == "id":
            element.attrib[key] = prefix + value
        elif REFERENCE.search(value):
            element.attrib[key] = value.replace("#", f"#{prefix}", 1)
