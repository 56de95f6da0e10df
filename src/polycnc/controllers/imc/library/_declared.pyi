# Written by scripts/reference from structures.h.
from ctypes import Array, c_double, c_int8, c_int16, c_int32, c_int64, c_uint8, c_uint16, c_uint32
from typing import Any, Final

from polycnc.controllers.library import Header, Structure, Union

HEADER: Header
ADAPTERS_MOST: Final = 16
DESCRIPTION_SIZE: Final = 256
SEGMENT_AXES_MOST: Final = 16
class NIC_INFO(Structure): description: Any
class WR_MUL_DES(Structure): addr: int; axis: int; len: int; data: Array[c_uint16]
class Src2Param(Structure): Src2_loc: int; Src2_axis: int; reserve: int
class Src2Data16(Structure): data: int; reserve1: int; reserve2: int
class Src2Data32(Structure): data: int; reserve: int
class Operand2(Union): param: Src2Param; data16: Src2Data16; data32: Src2Data32; data48: int
class EventInfo(Structure): EventCMD: int; EventType: int; Src1_loc: int; Src1_axis: int; Src2: Operand2; dest_loc: int; dest_axis: int; reserve: int
class PFIFOSegData(Structure): datanum: int; SegEndData: Array[c_int32]; CenterX: int; CenterY: int; dir: int
class PFIFOSegInfo(Structure): SegTgVel: int; SegEndVel: int; data: PFIFOSegData
