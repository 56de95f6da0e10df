# Written by scripts/reference from structures.h.
from ctypes import Array, c_double, c_int8, c_int16, c_int32, c_int64, c_uint8, c_uint16, c_uint32
from typing import Any, Final

from polycnc.controllers.library import Header, Structure, Union

HEADER: Header
MAXAXIS: Final = 18
COMMON_VARIABLES: Final = 1000
SIZE_STRREV: Final = 80
ENVIRONMENT_STRING_BYTES: Final = 1024
class AS(Structure): unoa: int; san: Array[c_int32]
class TSRP(Structure): an: int; kp: float; ki: float; kd: float; kpl: float; kfca: float; kfcv: float; jac: float; jvl: float; jtv: float; jovr: float; hac: float; hvl: float; rp: float; dp: float; tp: float; sll: float; slr: float; ipw: float; mpe: float; gf: float; mcp: int; axst: int; lsm: int; epc: int; digi: int; digo: int; ifs: int; scratch: Array[c_int32]; aux: float; lp: float; dv: float; sdec: float
class TRU(Structure): pu: int; tu: int
class LMP(Structure): ac: float; vl: float; tvl: float; dtm: Array[c_double]
class CMP(Structure): ac: float; vl: float; tvl: float; phi: float; dtca1: float; dtca2: float
class HMP(Structure): ac: float; vl: float; tvl: float; phi: float; dtca1: float; dtca2: float; dtm: Array[c_double]
class HMP3D(Structure): ac: float; vl: float; tvl: float; phi: float; dtca1: float; dtca2: float; dtca3: float; pn1: float; pn2: float; pn3: float; dtm: Array[c_double]
class ROSI(Structure): revision: str; number_axis: int; sysfile_loaded: int
class CBCNCT(Structure): task_number: int; size: int; buffer: bytearray
class CNCTS(Structure): errnum: int; errline: int; stackfree: int; running: int; csrcline: int
class LATCH_INFOS(Structure): san: int
class CDBUF(Structure): cd: Array[c_double]
class CIBUF(Structure): ci: Array[c_int32]
class SPDBUF(Structure): position: Array[c_double]
class CTRLPARAMS(Structure): parameters: Array[Any]
class CppString(Structure): text: str
