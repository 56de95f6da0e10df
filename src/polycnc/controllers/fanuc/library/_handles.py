"""Functions that open and close handles (Manual 000, communication), and those about nodes of its header."""

from __future__ import annotations

from typing import Annotated

from polycnc.controllers.fanuc.library._call import session_call
from polycnc.controllers.fanuc.library._codes import EW
from polycnc.controllers.fanuc.library._network import NODES, Session
from polycnc.controllers.fanuc.library._structs import ODBNODE
from polycnc.controllers.library import LONG, TEXT, USHORT, Out, Refused


@session_call
def cnc_allclibhndl(session: Session) -> tuple[EW, Annotated[USHORT, Out("FlibHndl")]]:
    """Open a handle of the default node, 0 if no other was set (Manual 000, cnc_allclibhndl)."""
    return EW.EW_OK, session.link(session.default_node)


@session_call
def cnc_allclibhndl2(session: Session, node: LONG) -> tuple[EW, Annotated[USHORT, Out("FlibHndl")]]:
    """Open a handle of node 0 to 7 (Manual 000, cnc_allclibhndl2)."""
    return EW.EW_OK, session.link(node)


@session_call
def cnc_allclibhndl3(
    session: Session, ip: Annotated[str, TEXT], port: USHORT, timeout: LONG
) -> tuple[EW, Annotated[USHORT, Out("FlibHndl")]]:
    """Open a handle of a control on the network by its address; it answers within `timeout` s, 0: for ever."""
    if timeout < 0 or not port:
        raise Refused(EW.EW_SOCKET)
    return EW.EW_OK, session.connect(ip, port, timeout or None)


@session_call
def cnc_freelibhndl(session: Session, FlibHndl: USHORT) -> EW:  # noqa: N803
    """Close a handle; its open transfers are broken off (Manual 000, cnc_freelibhndl)."""
    session.free(FlibHndl)
    return EW.EW_OK


@session_call
def cnc_rdnodenum(session: Session) -> tuple[EW, Annotated[LONG, Out("node_num")]]:
    """Return how many nodes there are."""
    return EW.EW_OK, len(session.nodes)


@session_call
def cnc_rdnodeinfo(session: Session, node: LONG) -> tuple[EW, Annotated[ODBNODE, Out("info")]]:
    """Describe a node."""
    if node not in NODES:
        raise Refused(EW.EW_NUMBER)
    there = session.nodes.get(node)
    info = ODBNODE(node_no=node)
    if there is not None:
        info.status = 1
        info.cnc_type = ord(there.device.model)
        info.node_name = f"Power Mate-{there.device.model}".encode()
    return EW.EW_OK, info


@session_call
def cnc_setdefnode(session: Session, node: LONG) -> EW:
    """Let `cnc_allclibhndl` open another node than 0."""
    if node not in NODES:
        raise Refused(EW.EW_NUMBER)
    session.default_node = node
    return EW.EW_OK


__all__ = [
    "cnc_allclibhndl",
    "cnc_allclibhndl2",
    "cnc_allclibhndl3",
    "cnc_freelibhndl",
    "cnc_rdnodeinfo",
    "cnc_rdnodenum",
    "cnc_setdefnode",
]
