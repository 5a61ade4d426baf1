"""XML of others, read without trust: no entities, no depth, no size without end."""

from __future__ import annotations

from typing import Any
from xml.etree.ElementTree import Element, TreeBuilder
from xml.parsers import expat

__all__ = ["XmlRefusedError", "parse_xml", "text_at"]

_MAX_BYTES = 64 * 2**20
_MAX_DEPTH = 100


class XmlRefusedError(ValueError):
    """A document that is no XML, or not of the harmless sort."""


def parse_xml(content: bytes) -> Element:
    """The root of a document, its names without namespaces.

    Parameters
    ----------
    content : bytes
        In any encoding that it declares and expat knows.

    Raises
    ------
    ValueError
        If it is not well formed, declares entities, or is far larger or deeper than metadata are.
    """
    if len(content) > _MAX_BYTES:
        raise XmlRefusedError(f"it has {len(content)} bytes, far more than metadata have")
    builder, depth = TreeBuilder(), 0

    def start(name: str, attributes: dict[str, str]) -> None:
        nonlocal depth
        depth += 1
        if depth > _MAX_DEPTH:
            raise XmlRefusedError(f"its elements are nested more than {_MAX_DEPTH} deep")
        builder.start(_local(name), {_local(key): text for key, text in attributes.items()})

    def end(name: str) -> None:
        nonlocal depth
        depth -= 1
        builder.end(_local(name))

    def entity(*declaration: Any) -> None:
        raise XmlRefusedError("it declares entities, which metadata do not need")

    parser = expat.ParserCreate(namespace_separator="}")
    parser.buffer_text = True
    parser.StartElementHandler, parser.EndElementHandler = start, end
    parser.CharacterDataHandler, parser.EntityDeclHandler = builder.data, entity
    try:
        parser.Parse(content, True)
        return builder.close()
    except (expat.ExpatError, AssertionError, LookupError, UnicodeError) as error:
        raise XmlRefusedError(f"it is not well-formed XML ({error})") from error


def _local(name: str) -> str:
    return name.rpartition("}")[2]


def text_at(root: Element | None, path: str) -> str | None:
    """The text of the first element of a path, stripped; None where there is none."""
    found = None if root is None else root.find(path)
    text = None if found is None or found.text is None else found.text.strip()
    return text or None
