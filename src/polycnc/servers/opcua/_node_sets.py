"""The official node sets, from a folder of the user: found by their namespaces, loaded in order."""

from __future__ import annotations

import asyncio
import re
import xml.etree.ElementTree as ElementTree
from collections.abc import Mapping
from pathlib import Path

from asyncua import Server

from polycnc.errors import UsageError
from polycnc.servers.opcua._model import CNC, DI, MACHINE_TOOL, MACHINERY

IN_ORDER = (
    DI,
    "http://opcfoundation.org/UA/IA/",
    MACHINERY,
    "http://opcfoundation.org/UA/ISA95-JOBCONTROL_V2/",
    "http://opcfoundation.org/UA/Machinery/Jobs/",
    MACHINE_TOOL,
    CNC,
)
"""The node sets that are needed, each after those it stands on."""
_SOURCE = "They are published by the OPC Foundation (github.com/OPCFoundation/UA-Nodeset)."
_MOST_BYTES = 32 << 20
_FIRST_URI = re.compile(rb"<NamespaceUris>.*?<Uri>\s*([^<]+?)\s*</Uri>", re.DOTALL)
_XML = "{http://opcfoundation.org/UA/2011/03/UANodeSet.xsd}"
_OBJECTS = "i=85"


def find_node_sets(folder: Path) -> Mapping[str, Path]:
    """Return the files of the node sets that are needed.

    Raises:
        UsageError: The folder cannot be read, or one of them is not there.
    """
    found: dict[str, Path] = {}
    try:
        for path in sorted(folder.iterdir()):
            if path.suffix.lower() == ".xml" and path.stat().st_size <= _MOST_BYTES:
                first = _FIRST_URI.search(path.read_bytes())
                if first is not None:
                    found.setdefault(first[1].decode("utf-8", "replace"), path)
    except OSError as error:
        raise UsageError(
            f"{folder}: node sets cannot be read: {error.strerror}", hint="Name a folder of XML files."
        ) from None
    for uri in IN_ORDER:
        if uri not in found:
            raise UsageError(
                f"{folder}: there is no node set of {uri}",
                hint=f"{_SOURCE} Without the option, none are needed.",
            )
    return {uri: found[uri] for uri in IN_ORDER}


async def load_node_sets(server: Server, files: Mapping[str, Path]) -> None:
    """Load them; of OPC 40502 only the types, as its node set of 2017 holds examples and an object `test`.

    Raises:
        UsageError: One of them is no node set.
    """
    for uri, path in files.items():
        await asyncio.sleep(0)  # whoever wants it to end already
        try:
            text = types_only(path.read_bytes()) if uri == CNC else path.read_bytes()
            await server.import_xml(xmlstring=text, auto_load_definitions=False)
        except Exception as error:
            raise UsageError(
                f"{path}: cannot be loaded as a node set: {error!r:.200}", hint=f"Get it anew. {_SOURCE}"
            ) from None


def types_only(content: bytes) -> bytes:
    """Return a node set without the objects that belong to no type."""
    root = ElementTree.fromstring(content)
    parents: dict[str, list[str]] = {}
    for node in root:
        inverse = [
            each.text or "" for each in node.iter(f"{_XML}Reference") if each.get("IsForward") == "false"
        ]
        parents[node.get("NodeId", "")] = inverse

    def belongs(name: str, seen: frozenset[str]) -> bool:
        if name not in parents:
            return name != _OBJECTS
        if name in types:
            return True
        return any(belongs(each, seen | {name}) for each in parents[name] if each not in seen)

    types = {node.get("NodeId", "") for node in root if node.tag.endswith("Type")}
    for node in [each for each in root if each.get("NodeId")]:
        if not belongs(node.get("NodeId", ""), frozenset()):
            root.remove(node)
            continue
        for references in node.iter(f"{_XML}References"):
            for each in [each for each in references if _is_event_from(each)]:
                references.remove(each)  # its direction would make the emitting type the parent
    return ElementTree.tostring(root)


def _is_event_from(reference: ElementTree.Element) -> bool:
    kind = reference.get("ReferenceType")
    return kind in ("GeneratesEvent", "i=41") and reference.get("IsForward") == "false"
