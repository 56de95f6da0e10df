"""Functions that send paths, contour points and events, and that fetch captures (manual 004, 3.5 to 3.9)."""

# ruff: noqa: N802, N803  the names are the manual's

from __future__ import annotations

from polycnc.controllers.imc.core._event_codes import SHAPES, EventCommand, EventType, constant_words
from polycnc.controllers.imc.core._event_codes import TAKE as TAKE_SECOND
from polycnc.controllers.imc.core._instructions import Event, InstallEvents, Segment
from polycnc.controllers.imc.core._instructions import Points as Displacements
from polycnc.controllers.imc.core._parameters import address
from polycnc.controllers.imc.library._call import LIBRARY, card_call, check_place, send, taken
from polycnc.controllers.imc.library._codes import (
    IMC_INVALID_PARAM,
    IMC_OK,
    IMC_OUT_OF_RANGE,
    IMC_STATUS,
    SEL_CFIFO,
    SEL_PFIFO1,
    SEL_PFIFO2,
)
from polycnc.controllers.imc.library._declared import SEGMENT_AXES_MOST, PFIFOSegData
from polycnc.controllers.imc.library._memory import signed_32
from polycnc.controllers.imc.library._network import IMC_HANDLE
from polycnc.controllers.imc.library._structs import EventInfo
from polycnc.controllers.imc.library._types import (
    IMC32,
    AnyQueue,
    ArcDirection,
    Axis,
    CaptureCount,
    Captured,
    CapturedLeft,
    CapturedNumber,
    EventCount,
    Events,
    PathQueue,
    PointQueue,
    Points,
    PointWords,
    Queue,
    SegmentData,
    SegmentInfo,
)
from polycnc.controllers.library import Refused

CLOCKWISE = 1  # of the functions that take coordinates one by one; in the structure it is 0
_AXES_OF_POINTS: dict[int, int] = {
    SEL_CFIFO: address("groupnum"),
    SEL_PFIFO1: address("pathaxisnum1"),
    SEL_PFIFO2: address("pathaxisnum2"),
}


@card_call
def IMC_AddLineNWithVel(Handle: IMC_HANDLE, pdata: SegmentInfo, fifoSel: PathQueue) -> IMC_STATUS:
    """Add a line of N axes with its own speeds (Manual 004, 3.5.1)."""
    speeds = pdata.SegTgVel, pdata.SegEndVel
    return send(Handle, fifoSel, _segment(Handle, pdata.data, speeds, arc=False))


@card_call
def IMC_AddLineN(Handle: IMC_HANDLE, pdata: SegmentData, fifoSel: PathQueue) -> IMC_STATUS:
    """Add a line of N axes with the speeds of the path space (Manual 004, 3.5.2)."""
    return send(Handle, fifoSel, _segment(Handle, pdata, None, arc=False))


@card_call
def IMC_AddArcLineWithVel(Handle: IMC_HANDLE, pdata: SegmentInfo, fifoSel: PathQueue) -> IMC_STATUS:
    """Add an arc of the first two axes, the others following evenly, with its own speeds (Manual 004, 3.5.3)."""
    speeds = pdata.SegTgVel, pdata.SegEndVel
    return send(Handle, fifoSel, _segment(Handle, pdata.data, speeds, arc=True))


@card_call
def IMC_AddArcLine(Handle: IMC_HANDLE, pdata: SegmentData, fifoSel: PathQueue) -> IMC_STATUS:
    """Add an arc of the first two axes, the others following, with the speeds of the space (Manual 004, 3.5.4)."""
    return send(Handle, fifoSel, _segment(Handle, pdata, None, arc=True))


@card_call
def IMC_AddArcWithVel(
    Handle: IMC_HANDLE,
    TgVel: IMC32,
    EndVel: IMC32,
    Endx: IMC32,
    Endy: IMC32,
    centerX: IMC32,
    centerY: IMC32,
    dir: ArcDirection,
    fifoSel: PathQueue,
) -> IMC_STATUS:
    """Add an arc of two axes with its own speeds; `dir` 0 counter-clockwise, 1 clockwise (Manual 004, 3.5.5)."""
    return send(Handle, fifoSel, _arc((Endx, Endy), (centerX, centerY), dir, (TgVel, EndVel)))


@card_call
def IMC_AddArc(
    Handle: IMC_HANDLE,
    Endx: IMC32,
    Endy: IMC32,
    centerX: IMC32,
    centerY: IMC32,
    dir: ArcDirection,
    fifoSel: PathQueue,
) -> IMC_STATUS:
    """Add an arc of two axes; `dir` 0 counter-clockwise, 1 clockwise (Manual 004, 3.5.6)."""
    return send(Handle, fifoSel, _arc((Endx, Endy), (centerX, centerY), dir, None))


@card_call
def IMC_AddSpiralWithVel(
    Handle: IMC_HANDLE,
    TgVel: IMC32,
    EndVel: IMC32,
    Endx: IMC32,
    Endy: IMC32,
    EndLine: IMC32,
    centerX: IMC32,
    centerY: IMC32,
    dir: ArcDirection,
    fifoSel: PathQueue,
) -> IMC_STATUS:
    """Add a helix with its own speeds: an arc of X and Y, Z going to `EndLine` (Manual 004, 3.5.7)."""
    return send(Handle, fifoSel, _arc((Endx, Endy, EndLine), (centerX, centerY), dir, (TgVel, EndVel)))


@card_call
def IMC_AddSpiral(
    Handle: IMC_HANDLE,
    Endx: IMC32,
    Endy: IMC32,
    EndLine: IMC32,
    centerX: IMC32,
    centerY: IMC32,
    dir: ArcDirection,
    fifoSel: PathQueue,
) -> IMC_STATUS:
    """Add a helix: an arc of X and Y, Z going to `EndLine` (Manual 004, 3.5.8)."""
    return send(Handle, fifoSel, _arc((Endx, Endy, EndLine), (centerX, centerY), dir, None))


@card_call
def IMC_PutContourData(
    Handle: IMC_HANDLE, pdata: Points, nWords: PointWords, fifoSel: PointQueue
) -> IMC_STATUS:
    """Add points of a contour: displacements of 16 bits, axis after axis, point after point (Manual 004, 3.6).

    Only whole points: `nWords`, at most 126, is a multiple of the number of axes if that is set: of groupnum for CFIFO.
    A path queue takes points too, of pathaxisnum axes; these are traversed with segtgvel and pathacc.
    """
    if nWords > len(pdata):
        raise Refused(IMC_OUT_OF_RANGE)
    values = [int(pdata[k]) for k in range(nWords)]
    card = Handle.reach()
    axes = int(card.read_words(_AXES_OF_POINTS[fifoSel], 0, 1)[0])
    if (axes and nWords % axes) or any(not -0x8000 <= value <= 0x7FFF for value in values):
        raise Refused(IMC_OUT_OF_RANGE)
    if fifoSel != SEL_CFIFO:
        return send(Handle, fifoSel, Displacements(tuple(values)))
    if nWords > card.config.depths.cfifo:
        raise Refused(IMC_OUT_OF_RANGE)
    return taken(Handle, card.push_points(values))


@card_call
def IMC_InstallEvent(Handle: IMC_HANDLE, pEvent: Events, EventNum: EventCount, fifoSel: Queue) -> IMC_STATUS:
    """Add up to 31 events to the card, which holds 128 (Manual 004, 3.7.1)."""
    if EventNum > len(pEvent):
        raise Refused(IMC_OUT_OF_RANGE)
    events = tuple(_event(Handle, pEvent[k]) for k in range(EventNum))
    if len(events) > Handle.reach().room_for_events:
        raise Refused(IMC_OUT_OF_RANGE)
    return send(Handle, fifoSel, InstallEvents(events))


@card_call
def IMC_ClearFIFO(Handle: IMC_HANDLE, fifoSel: AnyQueue) -> IMC_STATUS:
    """Empty a queue and end the wait that it is in (Manual 004, 3.8)."""
    Handle.reach().clear_fifo(fifoSel)
    return IMC_OK


@card_call
def IMC_GetCapData(
    Handle: IMC_HANDLE, rdnum: CaptureCount, axis: Axis
) -> tuple[IMC_STATUS, Captured, CapturedNumber, CapturedLeft]:
    """Take up to `rdnum`, at most 120, captured positions: return them, their number and how many are left.

    Bit 10 of encpctr lets the probe capture (Manual 004, 3.9).
    """
    positions, left = Handle.reach_later().read_capture(axis, rdnum)
    return IMC_OK, list(positions), len(positions), left


def _segment(handle: IMC_HANDLE, data: PFIFOSegData, speeds: tuple[int, int] | None, *, arc: bool) -> Segment:
    least, most = (2 if arc else 1), min(SEGMENT_AXES_MOST, handle.axis_count)
    if not least <= data.datanum <= most:
        raise Refused(IMC_OUT_OF_RANGE)
    ends = tuple(data.SegEndData[0 : data.datanum])
    center = (data.CenterX, data.CenterY) if arc else None
    return _made(ends, center, speeds, clockwise=data.dir & 0xFFFF == 0)


def _arc(
    ends: tuple[int, ...], center: tuple[int, int], direction: int, speeds: tuple[int, int] | None
) -> Segment:
    return _made(ends, center, speeds, clockwise=direction == CLOCKWISE)


def _made(
    ends: tuple[int, ...], center: tuple[int, int] | None, speeds: tuple[int, int] | None, *, clockwise: bool
) -> Segment:
    coordinates = tuple(signed_32(end) for end in ends)
    if center is not None:
        center = signed_32(center[0]), signed_32(center[1])
    if speeds is None:
        return Segment(coordinates, center, clockwise)
    return Segment(coordinates, center, clockwise, signed_32(speeds[0]), signed_32(speeds[1]))


def _event(handle: IMC_HANDLE, info: EventInfo) -> Event:
    """Return the event that a structure describes.

    Raises:
        Refused: It has an unknown command or type, or names what the card does not have.
    """
    try:
        command, when = EventCommand(info.EventCMD), EventType(info.EventType)
    except ValueError:
        raise Refused(IMC_OUT_OF_RANGE) from None
    operation = SHAPES[command][0]
    first, second, constant, target_axis = (0, 0), (0, 0), 0, 0
    if operation != TAKE_SECOND:
        first = _operand(handle, info.Src1_loc, info.Src1_axis)
    if constant_words(command) == 0:
        second = _operand(handle, info.Src2.param.Src2_loc, info.Src2.param.Src2_axis)
    elif constant_words(command) == 1:
        constant = info.Src2.data16.data
    elif constant_words(command) == 2:
        constant = info.Src2.data32.data
    else:
        constant = info.Src2.data48
    if info.dest_loc != 0:
        target_axis = check_place(handle, info.dest_loc, info.dest_axis, written=True)
    elif operation == TAKE_SECOND:
        raise Refused(IMC_INVALID_PARAM)
    return Event(command, when, *first, *second, constant, info.dest_loc, target_axis)


def _operand(handle: IMC_HANDLE, at: int, axis: int) -> tuple[int, int]:
    return at, check_place(handle, at, axis)


# Other names: as the manual misprints them, and for what its print has lost.
IMC_AddApiralWithVel = LIBRARY.alias("IMC_AddApiralWithVel", IMC_AddSpiralWithVel)
IMC_AddApiralWitchVel = LIBRARY.alias("IMC_AddApiralWitchVel", IMC_AddSpiralWithVel)
IMC_AddContourData = LIBRARY.alias("IMC_AddContourData", IMC_PutContourData)

# fmt: off
__all__ = [
    "IMC_AddApiralWitchVel", "IMC_AddApiralWithVel", "IMC_AddArc", "IMC_AddArcLine",
    "IMC_AddArcLineWithVel", "IMC_AddArcWithVel", "IMC_AddContourData", "IMC_AddLineN",
    "IMC_AddLineNWithVel", "IMC_AddSpiral", "IMC_AddSpiralWithVel", "IMC_ClearFIFO", "IMC_GetCapData",
    "IMC_InstallEvent", "IMC_PutContourData",
]
# fmt: on
