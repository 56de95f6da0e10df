"""Functions of a handle that stands for a control on the network: each is a request to its server.

One that reads a record into a structure is a row of `READINGS`; the record is that of the wire's table.
What is not here answers `EW_FUNC`, as do functions that the control does not know.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, TypeAlias, TypeVar

from polycnc.controllers.fanuc.data._macro_variables import (
    VACANT,
    Value,
    binary_pair,
    decimal_pair,
    from_binary,
    from_decimal,
)
from polycnc.controllers.fanuc.library._codes import ALL_AXES, EW
from polycnc.controllers.fanuc.library._structs import (
    HEADER,
    IODBMR,
    IODBPMC,
    IODBPSD,
    MAX_AXIS,
    ODBAXIS,
    ODBDY,
    ODBM,
    ODBUP,
)
from polycnc.controllers.fanuc.wire import (
    PMC,
    PMC_WIDTHS,
    POSITION_KINDS,
    Client,
    Reply,
    Request,
    Rows,
    Value8,
    WireRefusedError,
    layout_of,
    swapped,
)
from polycnc.controllers.library import Refused, layout, variant
from polycnc.errors import ProtocolError

_KINDS = {name: kind for kind, name in POSITION_KINDS.items()}
_POSITIONS = {
    "cnc_absolute": "absolute",
    "cnc_machine": "machine",
    "cnc_relative": "relative",
    "cnc_distance": "distance",
    "cnc_skip": "skip",
    "cnc_srvdelay": "servo_delay",
    "cnc_accdecdly": "acceleration_delay",
}
_DYNAMIC = ("absolute", "machine", "relative", "distance")
_FIELDS = {0: ("cdata", 0x80), 1: ("cdata", 0x80), 2: ("idata", 0), 3: ("ldata", 0)}
_WIDTHS = {"cdata": 1, "idata": 2, "ldata": 4}
_DECIMAL = 0
_AXIS_HEADER, _SINGLE, _DYNAMIC_HEADER, _PMC_HEADER = 4, 10, 22, 8

Reading: TypeAlias = tuple[dict[str, Any], list[dict[str, Any]]]


@dataclass(eq=False)
class RemoteLink:
    """What a handle of the network stands for: its connection, and what belongs to the handle alone."""

    client: Client
    macro_type: int = 0
    upload: bytes | None = None
    download: bytearray | None = None
    wide: bool = field(default=True)  # parameters in eight bytes, until the control knows only four

    def ask(self, *requests: Request) -> list[Reading]:
        """Return what the answers hold: the head of each, and what repeats.

        Raises:
            Refused: The control, or the way to it, refuses one.
        """
        replies: list[Reply] = reached(lambda: self.client.ask(requests))
        for reply in replies:
            if reply.status:
                raise Refused(_code(reply.status))
        try:
            return [
                layout_of(request).unpack(reply.payload)
                for request, reply in zip(requests, replies, strict=True)
            ]
        except ProtocolError:
            raise Refused(EW.EW_PROTOCOL) from None

    def values(self, request: Request) -> list[Value8]:
        """Return the numbers of one answer that has nothing but numbers."""
        ((_, rows),) = self.ask(request)
        return [value for row in rows for value in row.values()]

    def write(self, request: Request, *, each: Rows = (), **values: Any) -> EW:
        """Send what a record or several of them say; the request has no data yet."""
        data = layout_of(request).pack_data(list(each) if each else values)
        self.ask(replace(request, data=data))
        return EW.EW_OK


T = TypeVar("T")


def reached(action: Callable[[], T]) -> T:
    """Return what an action on the network gives.

    Raises:
        Refused: The control refuses it, is not there, or does not speak the protocol.
    """
    try:
        return action()
    except WireRefusedError as error:
        raise Refused(_code(error.code)) from None
    except ProtocolError:
        raise Refused(EW.EW_PROTOCOL) from None
    except (OSError, ValueError):
        raise Refused(EW.EW_SOCKET) from None


def _code(number: int) -> EW:
    return EW(number) if number in {each.value for each in EW} else EW.EW_UNEXP


def _check(holds: bool, code: EW) -> None:
    if not holds:
        raise Refused(code)


# ---------------------------------------------------------------------- what it is and does


@dataclass(frozen=True, slots=True)
class Row:
    """A function that reads a record into a structure: the requests, of which the first is the record's.

    Elements have the names of the record's fields, those of `names` excepted.
    """

    structure: str
    commands: tuple[int, ...]
    names: Mapping[str, str] = field(default_factory=dict)

    def read(self, link: RemoteLink) -> tuple[EW, Any]:
        """Ask, and fill the structure."""
        head, _ = link.ask(*map(Request, self.commands))[0]
        made = HEADER.classes[self.structure]
        fields = {each.name: self.names.get(each.name, each.name) for each in layout(made).fields}
        return EW.EW_OK, made(**{name: _whole(head[at]) for name, at in fields.items() if at in head})


def _whole(value: Any) -> Any:
    return value.mantissa if isinstance(value, Value8) else value


READINGS = {
    "cnc_sysinfo": Row("ODBSYS", (0x18,)),
    "cnc_statinfo": Row("ODBST", (0x19, 0xE1, 0x98)),
    "cnc_alarm": Row("ODBALM", (0x1A,), {"data": "alarms"}),
    "cnc_rdprgnum": Row("ODBPRO", (0x1C,), {"data": "running", "mdata": "main"}),
    "cnc_rdseqnum": Row("ODBSEQ", (0x1D,), {"data": "sequence"}),
    "cnc_actf": Row("ODBACT", (0x24,), {"data": "feed"}),
}
"""The functions that read one record, by name."""


def _read_positions(name: str) -> Callable[..., tuple[EW, ODBAXIS]]:
    def read(link: RemoteLink, axis: int, length: int) -> tuple[EW, ODBAXIS]:
        _check(axis == ALL_AXES or axis >= 1, EW.EW_ATTRIB)
        _check(length >= _AXIS_HEADER + 4, EW.EW_LENGTH)
        values = link.values(Request(0x26, (_KINDS[name], axis, 0, 0)))
        count = min(
            len(values), (length - _AXIS_HEADER) // 4
        )  # nothing is known of more than the control has
        made = variant(ODBAXIS, data=max(count, MAX_AXIS))(type=axis)
        made.data[:count] = [each.mantissa for each in values[:count]]
        return EW.EW_OK, made

    return read


def cnc_rddynamic(link: RemoteLink, axis: int, length: int) -> tuple[EW, ODBDY]:
    _check(axis == ALL_AXES or axis >= 1, EW.EW_ATTRIB)
    _check(length >= _DYNAMIC_HEADER + 16, EW.EW_LENGTH)
    codes = (Request(each) for each in (0x1A, 0x1C, 0x1D, 0x24, 0x25))
    places = (Request(0x26, (_KINDS[name], axis, 0, 0)) for name in _DYNAMIC)
    *states, absolute, machine, relative, distance = link.ask(*codes, *places)
    read = {name: _whole(value) for head, _ in states for name, value in head.items()}
    made = ODBDY(
        axis=axis,
        alarm=read["alarms"],
        prgnum=read["running"],
        prgmnum=read["main"],
        seqnum=read["sequence"],
        actf=read["feed"],
        acts=read["rpm"],
    )
    for name, (_, rows) in zip(_DYNAMIC, (absolute, machine, relative, distance), strict=True):
        values = [each["position"].mantissa for each in rows]
        if axis == ALL_AXES:
            room = getattr(made.pos.faxis, name)
            count = min(len(values), len(room), (length - _DYNAMIC_HEADER) // 16)
            room[:count] = values[:count]
        else:
            _check(bool(values), EW.EW_PROTOCOL)
            setattr(made.pos.oaxis, name, values[0])
    return EW.EW_OK, made


# ---------------------------------------------------------------------- data


def _pair(link: RemoteLink, value: Value8) -> tuple[int, int]:
    if value.number is None:
        return VACANT
    return decimal_pair(value.number) if link.macro_type == _DECIMAL else binary_pair(value.number)


def _macro(link: RemoteLink, mantissa: int, exponent: int) -> Value8:
    try:
        made: Value | None = (from_decimal if link.macro_type == _DECIMAL else from_binary)(
            mantissa, exponent
        )
    except ValueError:
        raise Refused(EW.EW_DATA) from None
    if made is None:
        return Value8.of(None, 0)
    mantissa, decimals = made.pair or decimal_pair(made.number)
    _check((mantissa, decimals) != (-1, -1), EW.EW_DATA)
    return Value8(mantissa, decimals)


def cnc_rdmacro(link: RemoteLink, number: int, length: int) -> tuple[EW, ODBM]:
    _check(length >= _SINGLE, EW.EW_LENGTH)
    values = link.values(Request(0x15, (number, number, 0, 0)))
    _check(len(values) == 1, EW.EW_PROTOCOL)
    mantissa, exponent = _pair(link, values[0])
    return EW.EW_OK, ODBM(datano=number, mcr_val=mantissa, dec_val=exponent)


def cnc_wrmacro(link: RemoteLink, number: int, length: int, mcr_val: int, dec_val: int) -> EW:
    _check(length >= _SINGLE, EW.EW_LENGTH)
    return link.write(Request(0x16, (number, number, 0, 0)), each=[_macro(link, mcr_val, dec_val)])


def cnc_rdmacror(link: RemoteLink, s_number: int, e_number: int, length: int) -> tuple[EW, IODBMR]:
    _check(e_number >= s_number, EW.EW_NUMBER)
    count = e_number - s_number + 1
    _check(length >= 6 + 6 * count, EW.EW_LENGTH)
    values = link.values(Request(0x15, (s_number, e_number, 0, 0)))
    _check(len(values) == count, EW.EW_PROTOCOL)
    made = variant(IODBMR, data=count)(datano_s=s_number, datano_e=e_number)
    for entry, value in zip(made.data, values, strict=True):
        entry.mcr_val, entry.dec_val = _pair(link, value)
    return EW.EW_OK, made


def cnc_wrmacror(link: RemoteLink, length: int, macror: IODBMR) -> EW:
    first, last = macror.datano_s, macror.datano_e
    _check(last >= first, EW.EW_NUMBER)
    count = last - first + 1
    _check(length >= 6 + 6 * count and count <= len(macror.data), EW.EW_LENGTH)
    values = [
        _macro(link, entry.mcr_val, entry.dec_val)
        for entry, _ in zip(macror.data, range(count), strict=False)
    ]
    return link.write(Request(0x16, (first, last, 0, 0)), each=values)


def cnc_getmactype(link: RemoteLink) -> tuple[EW, int]:
    return EW.EW_OK, link.macro_type


def cnc_setmactype(link: RemoteLink, macro_type: int) -> EW:
    link.macro_type = macro_type
    return EW.EW_OK


def cnc_rdparam(link: RemoteLink, number: int, axis: int, length: int) -> tuple[EW, IODBPSD]:
    _check(length >= _AXIS_HEADER + 1, EW.EW_LENGTH)
    while True:
        try:
            ((_, records),) = link.ask(Request(0x8D if link.wide else 0x0E, (number, number, axis, 0)))
            break
        except Refused as refusal:
            if refusal.code != EW.EW_FUNC or not link.wide:
                raise
            link.wide = False
    _check(bool(records) and bool(records[0].get("values")), EW.EW_PROTOCOL)
    kind, values = records[0]["type"], [_whole(each) for each in records[0]["values"]]
    _check(kind in _FIELDS, EW.EW_PROTOCOL)
    made = IODBPSD(datano=number, type=axis)
    name, sign = _FIELDS[kind]
    most = (length - _AXIS_HEADER) // _WIDTHS[name]  # nothing is known of more axes than the control has
    _check(most >= 1, EW.EW_LENGTH)
    values = [value - 256 if sign and value >= sign else value for value in values]
    if axis == ALL_AXES:
        room = getattr(made.u, f"{name}s")
        for k, value in enumerate(values[: min(most, len(room))]):
            room[k] = value
    else:
        setattr(made.u, name, values[0])
    return EW.EW_OK, made


def pmc_rdpmcrng(
    link: RemoteLink, adr_type: int, data_type: int, s_number: int, e_number: int, length: int
) -> tuple[EW, IODBPMC]:
    _check(0 <= data_type < len(PMC_WIDTHS), EW.EW_ATTRIB)
    size, count = PMC_WIDTHS[data_type], e_number - s_number + 1
    _check(count >= 1, EW.EW_NUMBER)
    _check(count % size == 0 and length == _PMC_HEADER + count, EW.EW_LENGTH)
    ((head, _),) = link.ask(Request(0x8001, (s_number, e_number, adr_type, data_type), target=PMC))
    _check(len(head["values"]) == count, EW.EW_PROTOCOL)
    made = HEADER.make("IODBPMC", PMC_ITEMS=count // size)(
        type_a=adr_type, type_d=data_type, datano_s=s_number, datano_e=e_number
    )
    part = (made.u.cdata, made.u.idata, made.u.ldata)[data_type]
    memoryview(part).cast("B")[:] = swapped(head["values"], size)
    return EW.EW_OK, made


def pmc_wrpmcrng(link: RemoteLink, length: int, buf: bytes) -> EW:
    _check(_PMC_HEADER <= length <= len(buf), EW.EW_LENGTH)
    kind, data_type, first, last = struct.unpack_from("<4h", buf)
    _check(0 <= data_type < len(PMC_WIDTHS), EW.EW_ATTRIB)
    values = swapped(buf[_PMC_HEADER:length], PMC_WIDTHS[data_type])
    return link.write(Request(0x8002, (first, last, kind, data_type), target=PMC), values=values)


# ---------------------------------------------------------------------- programs


def cnc_search(link: RemoteLink, number: int) -> EW:
    try:
        link.ask(Request(0x03, (number, 0, 0, 0)))
    except Refused as refusal:  # the control answers 2, "no such program" in its detail
        raise Refused(EW.EW_DATA if refusal.code == EW.EW_LENGTH else refusal.code) from None
    return EW.EW_OK


def cnc_delete(link: RemoteLink, number: int) -> EW:
    link.ask(Request(0x05, (number, number, 0, 0)))
    return EW.EW_OK


def cnc_upstart(link: RemoteLink, number: int) -> EW:
    _check(link.upload is None, EW.EW_BUSY)
    link.upload = reached(lambda: link.client.upload(f"O{number:04d}-O{number:04d}"))
    return EW.EW_OK


def cnc_upload(link: RemoteLink, number: int) -> tuple[EW, ODBUP, int]:
    if link.upload is None:
        raise Refused(EW.EW_FUNC)
    _check(number > 0, EW.EW_LENGTH)
    piece, link.upload = link.upload[:number], link.upload[number:]
    return EW.EW_OK, variant(ODBUP, data=number)(data=piece), len(piece)


def cnc_upend(link: RemoteLink) -> EW:
    _check(link.upload is not None, EW.EW_FUNC)
    link.upload = None
    return EW.EW_OK


def cnc_dwnstart(link: RemoteLink) -> EW:
    _check(link.download is None, EW.EW_BUSY)
    link.download = bytearray()
    return EW.EW_OK


def cnc_download(link: RemoteLink, data: bytes, number: int) -> EW:
    if link.download is None:
        raise Refused(EW.EW_FUNC)
    _check(1 <= number <= 256 and len(data) >= number, EW.EW_LENGTH)
    link.download += data[:number]
    return EW.EW_OK


def cnc_dwnend(link: RemoteLink) -> EW:
    if link.download is None:
        raise Refused(EW.EW_FUNC)
    text, link.download = bytes(link.download), None
    reached(lambda: link.client.download(text))
    return EW.EW_OK


REMOTE: dict[str, Callable[..., Any]] = {
    **{name: row.read for name, row in READINGS.items()},
    **{name: _read_positions(kind) for name, kind in _POSITIONS.items()},
    **{
        function.__name__: function
        for function in (
            cnc_rddynamic, cnc_rdmacro, cnc_wrmacro, cnc_rdmacror, cnc_wrmacror, cnc_getmactype, cnc_setmactype,
            cnc_rdparam, pmc_rdpmcrng, pmc_wrpmcrng, cnc_search, cnc_delete, cnc_upstart, cnc_upload, cnc_upend,
            cnc_dwnstart, cnc_download, cnc_dwnend,
        )
    },
}  # fmt: skip
"""The functions that a handle of the network has, by name."""


def carry_out(link: RemoteLink, name: str, given: Sequence[Any]) -> Any:
    """Carry out a function on the network.

    Raises:
        Refused: The control, or the way to it, refuses; or no request does what the function does.
    """
    if name not in REMOTE:
        raise Refused(EW.EW_FUNC)
    return REMOTE[name](link, *given)
