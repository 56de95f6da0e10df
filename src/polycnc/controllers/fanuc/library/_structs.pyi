# Written by scripts/reference from structures.h.
from ctypes import Array, c_double, c_int8, c_int16, c_int32, c_int64, c_uint8, c_uint16, c_uint32
from typing import Any, Final

from polycnc.controllers.library import Header, Structure, Union

HEADER: Header
PACKINGS: dict[str, int | None]
__all__ = ['ODBACT', 'ODBAXIS', 'FAXIS', 'OAXIS', 'ODBDY_POS', 'ODBDY', 'FAXIS_D', 'ODBDY_POS_D', 'ODBDY_D', 'IDBWRR', 'ODBUP', 'PRGDIR', 'ODBNC_BIN', 'ODBNC_U', 'ODBNC', 'ODBPRO', 'ODBSEQ', 'ODBMDIP', 'ODBTOFS', 'IODBTO_U', 'IODBTO', 'ODBTLINF', 'IODBPSD_U', 'IODBPSD', 'PARAIF_INFO', 'ODBPARAIF', 'ODBM', 'IODBMR_DATA', 'IODBMR', 'ODBMVINF', 'ODBNODE', 'REC_ALM', 'REC_MDI', 'REC_SGN', 'REC_DATE', 'REC_TIME', 'ODBHIS_DATA', 'ODBHIS', 'ALM_HIS', 'ODBAHIS', 'IODBSIG_DATA', 'IODBSIG', 'ODBOPDI_u', 'ODBOPDI', 'ODBPOS', 'ODBEXEC', 'ODBFIN', 'ODBSYS', 'ODBSYSC', 'ODBST', 'ODBALM', 'ALM1', 'ALM2', 'ALMINFO_1', 'ALMINFO_2', 'ALMINFO_u', 'ALMINFO', 'MODAL_AUX', 'ODBMDL_u', 'ODBMDL', 'ODBDGN_u', 'ODBDGN', 'OPMSG', 'IODBSGNL', 'IODBGNRL', 'IODBRDNA', 'IODBPMC_u', 'IODBPMC', 'PMCINF', 'ODBPMCINF', 'MAX_AXIS', 'MAX_PBUF', 'MAX_RBUF', 'MSG_SIZE']
MAX_AXIS: Final = 6
MAX_RBUF: Final = 256
MAX_PBUF: Final = 256
MAX_OFFSETS: Final = 99
MAX_MACROS: Final = 500
MAX_INFO: Final = 100
MSG_SIZE: Final = 256
HISTORY_SIGNALS: Final = 20
PMC_ITEMS: Final = 256
MODAL_GROUPS: Final = 21
MODAL_ADDRESSES: Final = 27
RECORDS: Final = 1
ALARMS: Final = 1
class ODBACT(Structure): dummy: Array[c_int16]; data: int
class ODBAXIS(Structure): dummy: int; type: int; data: Array[c_int32]
class FAXIS(Structure): absolute: Array[c_int32]; machine: Array[c_int32]; relative: Array[c_int32]; distance: Array[c_int32]
class OAXIS(Structure): absolute: int; machine: int; relative: int; distance: int
class ODBDY_POS(Union): faxis: FAXIS; oaxis: OAXIS
class ODBDY(Structure): dummy: int; axis: int; alarm: int; prgnum: int; prgmnum: int; seqnum: int; actf: int; acts: int; pos: ODBDY_POS
class FAXIS_D(Structure): absolute: Array[c_int32]; machine: Array[c_int32]; relative: Array[c_int32]; distance: Array[c_int32]
class ODBDY_POS_D(Union): faxis: FAXIS_D; oaxis: OAXIS
class ODBDY_D(Structure): dummy: int; axis: int; alarm: int; prgnum: int; prgmnum: int; seqnum: int; actf: int; acts: int; pos: ODBDY_POS_D
class IDBWRR(Structure): datano: int; type: int; data: Array[c_int32]
class ODBUP(Structure): dummy: Array[c_int16]; data: bytes
class PRGDIR(Structure): prg_data: bytes
class ODBNC_BIN(Structure): reg_prg: int; unreg_prg: int; used_mem: int; unused_mem: int
class ODBNC_U(Union): bin: ODBNC_BIN; asc: bytes
class ODBNC(Structure): u: ODBNC_U
class ODBPRO(Structure): dummy: Array[c_int16]; data: int; mdata: int
class ODBSEQ(Structure): dummy: Array[c_int16]; data: int
class ODBMDIP(Structure): mdiprog: int; mdipntr: int; crntprog: int; crntpntr: int
class ODBTOFS(Structure): datano: int; type: int; data: int
class IODBTO_U(Union): m_ofs: Array[c_int32]; m_ofs_a: Array[c_int32]
class IODBTO(Structure): datano_s: int; type: int; datano_e: int; u: IODBTO_U
class ODBTLINF(Structure): ofs_type: int; use_no: int
class IODBPSD_U(Union): cdata: int; idata: int; ldata: int; cdatas: Array[c_int8]; idatas: Array[c_int16]; ldatas: Array[c_int32]
class IODBPSD(Structure): datano: int; type: int; u: IODBPSD_U
class PARAIF_INFO(Structure): prm_no: int; prm_type: int
class ODBPARAIF(Structure): info_no: int; prev_no: int; next_no: int; info: Array[PARAIF_INFO]
class ODBM(Structure): datano: int; dummy: int; mcr_val: int; dec_val: int
class IODBMR_DATA(Structure): mcr_val: int; dec_val: int
class IODBMR(Structure): datano_s: int; dummy: int; datano_e: int; data: Array[IODBMR_DATA]
class ODBMVINF(Structure): use_no1: int; use_no2: int
class ODBNODE(Structure): node_no: int; io_base: int; status: int; cnc_type: int; node_name: bytes
class REC_ALM(Structure): rec_type: int; alm_grp: int; alm_no: int; axis_no: int; dummy: int
class REC_MDI(Structure): rec_type: int; key_code: int; pw_flag: int; dummy: Array[c_int8]
class REC_SGN(Structure): rec_type: int; sig_name: int; sig_old: int; sig_new: int; dummy: int; sig_no: int
class REC_DATE(Structure): rec_type: int; year: int; month: int; day: int; pw_flag: int; dummy: Array[c_int8]
class REC_TIME(Structure): rec_type: int; hour: int; minute: int; second: int; pw_flag: int; dummy: Array[c_int8]
class ODBHIS_DATA(Union): rec_alm: REC_ALM; rec_mdi: REC_MDI; rec_sgn: REC_SGN; rec_date: REC_DATE; rec_time: REC_TIME
class ODBHIS(Structure): s_no: int; type: int; e_no: int; data: Array[ODBHIS_DATA]
class ALM_HIS(Structure): dummy: int; alm_grp: int; alm_no: int; axis_no: int; year: int; month: int; day: int; hour: int; minute: int; second: int; dummy2: int; len_msg: int; alm_msg: bytes
class ODBAHIS(Structure): s_no: int; type: int; e_no: int; alm_his: Array[ALM_HIS]
class IODBSIG_DATA(Structure): ent_no: int; sig_no: int; sig_name: int; mask_pat: int
class IODBSIG(Structure): datano: int; type: int; data: Array[IODBSIG_DATA]
class ODBOPDI_u(Union): cdata: int; idata: int; ldata: int
class ODBOPDI(Structure): axis: int; u: ODBOPDI_u
class ODBPOS(Structure): idata: int; ldata: int
class ODBEXEC(Structure): dummy: int; cdata: Array[Any]
class ODBFIN(Structure): dummy: int; cdata: Array[c_uint8]
class ODBSYS(Structure): dummy: int; max_axis: int; cnc_type: bytes; mt_type: bytes; series: bytes; version: bytes; axes: bytes
class ODBSYSC(Structure): slot_no_p: Array[c_int8]; slot_no_l: Array[c_int8]; mod_id: Array[c_int16]; soft_id: Array[c_int16]; s_series: Any; s_version: Any; dummy1: Array[c_int8]; m_rom: int; s_rom: int; svo_soft: bytes; pmc_soft: bytes; lad_soft: bytes; mcr_soft: Array[c_uint8]; spl1_soft: bytes; spl2_soft: bytes; frmmin: int; drmmin: int; srmmin: int; pmcmin: int; sv1min: int; sv3min: int; sv5min: int; sicmin: int; posmin: int; submin: int; hdiio: int; dummy2: Array[c_int16]
class ODBST(Structure): dummy: Array[c_int16]; aut: int; run: int; motion: int; mstb: int; emergency: int; alarm: int; edit: int
class ODBALM(Structure): dummy: Array[c_int16]; data: int
class ALM1(Structure): axis: int; alm_no: int
class ALM2(Structure): axis: int; alm_no: int; msg_len: int; alm_msg: bytes
class ALMINFO_1(Structure): alm: Array[ALM1]; data_end: int
class ALMINFO_2(Structure): alm: Array[ALM2]; data_end: int
class ALMINFO_u(Union): alm1: ALMINFO_1; alm2: ALMINFO_2
class ALMINFO(Structure): u: ALMINFO_u
class MODAL_AUX(Structure): aux_data: int; flag1: int; flag2: int
class ODBMDL_u(Union): g_data: int; g_rdata: Array[c_uint8]; aux: MODAL_AUX; raux1: Array[MODAL_AUX]; raux2: Array[MODAL_AUX]
class ODBMDL(Structure): datano: int; type: int; modal: ODBMDL_u
class ODBDGN_u(Union): cdata: int; idata: int; ldata: int; cdatas: Array[c_int8]; idatas: Array[c_int16]; ldatas: Array[c_int32]
class ODBDGN(Structure): datano: int; type: int; u: ODBDGN_u
class OPMSG(Structure): datano: int; type: int; char_num: int; data: bytes
class IODBSGNL(Structure): datano: int; type: int; mode: int; hndl_ax: int; hndl_mv: int; rpd_ovrd: int; jog_ovrd: int; feed_ovrd: int; spdl_ovrd: int; blck_del: int; sngl_blck: int; machn_lock: int; dry_run: int; mem_prtct: int; feed_hold: int
class IODBGNRL(Structure): datano: int; type: int; sgnal: int
class IODBRDNA(Structure): datano: int; type: int; sgnl1_name: bytes; sgnl2_name: bytes; sgnl3_name: bytes; sgnl4_name: bytes; sgnl5_name: bytes; sgnl6_name: bytes; sgnl7_name: bytes; sgnl8_name: bytes
class IODBPMC_u(Union): cdata: Array[c_int8]; idata: Array[c_int16]; ldata: Array[c_int32]
class IODBPMC(Structure): type_a: int; type_d: int; datano_s: int; datano_e: int; u: IODBPMC_u
class PMCINF(Structure): pmc_adr: int; adr_attr: int; top_num: int; last_num: int
class ODBPMCINF(Structure): datano: int; info: Array[PMCINF]
