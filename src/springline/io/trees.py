"""XML as nested lists, so that what is not understood is carried and written back as it stood."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from typing import TYPE_CHECKING, Any

from ..errors import FormatError

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

Tree = list[Any]
"""`[tag, text]` of a leaf, `[tag, [child, ...]]` of a branch; namespaces are left out."""


def parse(path: Path) -> ET.Element:
    """Return the root of an XML file.

    Raises:
        FormatError: It is not XML, or defines entities, which no exchange file needs and which can be made to harm.
    """
    raw = path.read_bytes()
    if b"<!ENTITY" in raw:
        raise FormatError("it defines entities", where=path, mend="remove its DOCTYPE")
    try:
        return ET.fromstring(raw)
    except (ET.ParseError, LookupError, ValueError) as error:
        raise FormatError(f"not an XML file: {error}", where=path) from None


def tag(element: ET.Element) -> str:
    """Return an element's name without its namespace."""
    return element.tag.rpartition("}")[2]


def child(element: ET.Element, name: str) -> ET.Element | None:
    """Return the first child of that name; None when there is none."""
    return next((one for one in element if tag(one) == name), None)


def children(element: ET.Element | None, name: str) -> list[ET.Element]:
    """Return the children of that name."""
    return [] if element is None else [one for one in element if tag(one) == name]


def text(element: ET.Element | None, name: str) -> str:
    """Return the text of a child, empty when there is none."""
    found = None if element is None else child(element, name)
    return "" if found is None or found.text is None else found.text.strip()


def to_tree(element: ET.Element, leave: Callable[[ET.Element], bool] = lambda _: False) -> Tree:
    """Return an element as nested lists; in place of a child that `leave` picks stands `[tag, None]`."""
    if len(element) == 0:
        return [tag(element), (element.text or "").strip()]
    return [tag(element), [[tag(one), None] if leave(one) else to_tree(one, leave) for one in element]]


def to_element(tree: Tree, fill: Callable[[str], ET.Element | None] = lambda _: None) -> ET.Element:
    """Return nested lists as an element; `fill` gives what stands where `to_tree` left a child out, None nothing."""
    element = ET.Element(tree[0])
    if isinstance(tree[1], str):
        element.text = clean(tree[1]) or None
        return element
    for one in tree[1]:
        made = fill(one[0]) if one[1] is None else to_element(one, fill)
        if made is not None:
            element.append(made)
    return element


def clean(words: str) -> str:
    """Return a text without the control characters that XML cannot hold.

    >>> clean("a\\x00b<c>")
    'ab<c>'
    """
    return "".join(c for c in words if c in "\t\n\r" or (c >= " " and c not in "\ufffe\uffff"))


def document(root: ET.Element, encoding: str = "utf-8") -> bytes:
    """Return an XML file; letters that its encoding lacks are written as character references."""
    ET.indent(root, "  ")
    return ET.tostring(root, encoding=encoding, xml_declaration=True) + b"\n"
