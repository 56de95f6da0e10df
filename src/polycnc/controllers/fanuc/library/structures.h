/* The structures of the Power Mate's function library (Manual 000).

`text` is a char that is one of a text, `octet` a char whose bits count; __counted_by(n) says how many elements of an
array count, or how many bytes a pointer leads to. */
/* Axes that structures have room for: those of a Power Mate-H; a Power Mate-D has 2. */
#define MAX_AXIS 6
#define MAX_RBUF 256
#define MAX_PBUF 256

/* Where the manual leaves a length open: that of its samples, or what there can be. What a function returns is as long
as what was read. */
#define MAX_OFFSETS 99
#define MAX_MACROS 500
#define MAX_INFO 100
#define MSG_SIZE 256
#define HISTORY_SIGNALS 20
#define PMC_ITEMS 256
#define MODAL_GROUPS 21
#define MODAL_ADDRESSES 27
#define RECORDS 1
#define ALARMS 1

typedef char text;
typedef unsigned char octet;

/* The diagrams pack to 2 bytes: a long may lie at an address that 4 does not divide. */
#pragma pack(2)

/* Actual feed. */
typedef struct { short dummy[2]; long data; } ODBACT;
/* One value per axis; of one axis it is the first. */
typedef struct { short dummy, type; long data[MAX_AXIS]; } ODBAXIS;
/* Positions of all axes. */
typedef struct { long absolute[MAX_AXIS], machine[MAX_AXIS], relative[MAX_AXIS], distance[MAX_AXIS]; } FAXIS;
/* Positions of one axis. */
typedef struct { long absolute, machine, relative, distance; } OAXIS;
/* Positions of all axes or of one. */
typedef union { FAXIS faxis; OAXIS oaxis; } ODBDY_POS;
/* What changes while a program runs, at one moment. */
typedef struct { short dummy, axis, alarm, prgnum, prgmnum; long seqnum, actf, acts; ODBDY_POS pos; } ODBDY;
/* Positions of all axes of a Power Mate-D. */
typedef struct { long absolute[2], machine[2], relative[2], distance[2]; } FAXIS_D;
/* Positions of all axes or of one, on a Power Mate-D. */
typedef union { FAXIS_D faxis; OAXIS oaxis; } ODBDY_POS_D;
/* ODBDY of a Power Mate-D, whose arrays have room for 2 axes. */
typedef struct {
    short dummy, axis, alarm, prgnum, prgmnum;
    long seqnum, actf, acts;
    ODBDY_POS_D pos;
} ODBDY_D;
/* Relative positions to preset. */
typedef struct { short datano, type; long data[MAX_AXIS]; } IDBWRR;
/* A piece of a program. */
typedef struct { short dummy[2]; text data[MAX_RBUF]; } ODBUP;
/* The directory of programs, as text. */
typedef struct { text prg_data[MAX_PBUF]; } PRGDIR;
/* Program memory in numbers. */
typedef struct { short reg_prg, unreg_prg; long used_mem, unused_mem; } ODBNC_BIN;

#pragma pack(1)

/* Program memory in numbers or as text. */
typedef union { ODBNC_BIN bin; text asc[31]; } ODBNC_U;
/* Program memory. */
typedef struct { ODBNC_U u; } ODBNC;

#pragma pack(2)

/* Program numbers. */
typedef struct { short dummy[2], data, mdata; } ODBPRO;
/* Sequence number. */
typedef struct { short dummy[2]; long data; } ODBSEQ;
/* Pointers of MDI operation. */
typedef struct { short mdiprog; long mdipntr; short crntprog; long crntpntr; } ODBMDIP;
/* One tool offset. */
typedef struct { short datano, type; long data; } ODBTOFS;
/* Tool offsets, of type 0 or of all types. */
typedef union { long m_ofs[MAX_OFFSETS], m_ofs_a[MAX_OFFSETS]; } IODBTO_U;
/* A range of tool offsets. */
typedef struct { short datano_s, type, datano_e; IODBTO_U u; } IODBTO;
/* What the tool offset memory is. */
typedef struct { short ofs_type, use_no; } ODBTLINF;
/* Value of a parameter, or its values of all axes. */
typedef union {
    char cdata;
    short idata;
    long ldata;
    char cdatas[MAX_AXIS];
    short idatas[MAX_AXIS];
    long ldatas[MAX_AXIS];
} IODBPSD_U;
/* A parameter. */
typedef struct { short datano, type; IODBPSD_U u; } IODBPSD;
/* Number and attributes of a parameter. */
typedef struct { short prm_no, prm_type; } PARAIF_INFO;
/* Parameters that there are. */
typedef struct {
    unsigned short info_no;
    short prev_no, next_no;
    PARAIF_INFO info[MAX_INFO] __counted_by(info_no);
} ODBPARAIF;
/* A custom macro variable. */
typedef struct { short datano, dummy; long mcr_val; short dec_val; } ODBM;
/* Value of a custom macro variable. */
typedef struct { long mcr_val; short dec_val; } IODBMR_DATA;
/* A range of custom macro variables. */
typedef struct {
    short datano_s, dummy, datano_e;
    IODBMR_DATA data[MAX_MACROS] __counted_by(datano_e - datano_s + 1);
} IODBMR;
/* Which custom macro variables there are. */
typedef struct { short use_no1, use_no2; } ODBMVINF;

#pragma pack(4)

/* A node, as the header of the library has it: 4-byte packing. */
typedef struct { long node_no, io_base, status, cnc_type; text node_name[20]; } ODBNODE;

#pragma pack(2)

/* An alarm in the operation history. */
typedef struct { short rec_type, alm_grp, alm_no; char axis_no, dummy; } REC_ALM;
/* A key in the operation history. */
typedef struct { short rec_type; unsigned char key_code; char pw_flag, dummy[4]; } REC_MDI;
/* A change of a signal in the operation history. */
typedef struct {
    short rec_type;
    char sig_name;
    unsigned char sig_old, sig_new;
    char dummy;
    short sig_no;
} REC_SGN;
/* A date in the operation history. */
typedef struct { short rec_type; char year, month, day, pw_flag, dummy[2]; } REC_DATE;
/* A time in the operation history. */
typedef struct { short rec_type; char hour, minute, second, pw_flag, dummy[2]; } REC_TIME;
/* A record of the operation history; all kinds begin with `rec_type`. */
typedef union {
    REC_ALM rec_alm;
    REC_MDI rec_mdi;
    REC_SGN rec_sgn;
    REC_DATE rec_date;
    REC_TIME rec_time;
} ODBHIS_DATA;
/* Records of the operation history. */
typedef struct {
    unsigned short s_no;
    short type;
    unsigned short e_no;
    ODBHIS_DATA data[RECORDS] __counted_by(e_no - s_no + 1);
} ODBHIS;
/* A record of the alarm history. */
typedef struct {
    short dummy, alm_grp, alm_no;
    char axis_no, year, month, day, hour, minute, second, dummy2;
    short len_msg;
    text alm_msg[32] __counted_by(len_msg);
} ALM_HIS;
/* Records of the alarm history. */
typedef struct {
    unsigned short s_no;
    short type;
    unsigned short e_no;
    ALM_HIS alm_his[RECORDS] __counted_by(e_no - s_no + 1);
} ODBAHIS;
/* A signal whose changes are noted. */
typedef struct { short ent_no, sig_no; char sig_name; unsigned char mask_pat; } IODBSIG_DATA;
/* The signals whose changes are noted. */
typedef struct { short datano, type; IODBSIG_DATA data[HISTORY_SIGNALS]; } IODBSIG;
/* The value of an operation signal. */
typedef union { unsigned char cdata; short idata; long ldata; } ODBOPDI_u;
/* An operation signal. */
typedef struct { short axis; ODBOPDI_u u; } ODBOPDI;
/* An axis, and a coordinate, a distance or a time. */
typedef struct { short idata; long ldata; } ODBPOS;
/* The state of the execution buffers: `cdata[0]` of the first, `cdata[1]` of the second ones. */
typedef struct { short dummy; octet cdata[2][8]; } ODBEXEC;
/* Completion flags by path. */
typedef struct { short dummy; unsigned char cdata[8]; } ODBFIN;
/* Kind, software and axes of the control; no text ends in a zero. */
typedef struct {
    short dummy, max_axis;
    text cnc_type[2], mt_type[2], series[4], version[4], axes[2];
} ODBSYS;
/* Software, memory modules and boards of the control. The manual calls both spare arrays `dummy`. */
typedef struct {
    char slot_no_p[16], slot_no_l[16];
    short mod_id[16], soft_id[16];
    text s_series[16][5], s_version[16][5];
    char dummy1[16];
    short m_rom, s_rom;
    text svo_soft[8], pmc_soft[6], lad_soft[6];
    unsigned char mcr_soft[8];
    text spl1_soft[6], spl2_soft[6];
    short frmmin, drmmin, srmmin, pmcmin, sv1min, sv3min, sv5min, sicmin, posmin, submin, hdiio,
        dummy2[32];
} ODBSYSC;
/* The state of the control. */
typedef struct { short dummy[2], aut, run, motion, mstb, emergency, alarm, edit; } ODBST;
/* The alarm groups, as bits of a signed number. */
typedef struct { short dummy[2], data; } ODBALM;
/* An alarm without its text. */
typedef struct { short axis, alm_no; } ALM1;
/* An alarm with its text. */
typedef struct { short axis, alm_no, msg_len; text alm_msg[32] __counted_by(msg_len); } ALM2;
/* Alarms without their texts; the end mark follows the last. */
typedef struct { ALM1 alm[ALARMS]; short data_end; } ALMINFO_1;
/* Alarms with their texts. */
typedef struct { ALM2 alm[ALARMS]; short data_end; } ALMINFO_2;
/* Alarms of one kind or the other. */
typedef union { ALMINFO_1 alm1; ALMINFO_2 alm2; } ALMINFO_u;
/* Alarms. */
typedef struct { ALMINFO_u u; } ALMINFO;
/* The value of an address or axis and what is known about it. */
typedef struct { long aux_data; unsigned char flag1, flag2; } MODAL_AUX;
/* Modal data of one kind or of all. */
typedef union {
    unsigned char g_data, g_rdata[MODAL_GROUPS];
    MODAL_AUX aux, raux1[MODAL_ADDRESSES], raux2[MAX_AXIS];
} ODBMDL_u;
/* Modal data. */
typedef struct { short datano, type; ODBMDL_u modal; } ODBMDL;
/* A diagnosis value, or those of all axes. */
typedef union {
    char cdata;
    short idata;
    long ldata;
    char cdatas[MAX_AXIS];
    short idatas[MAX_AXIS];
    long ldatas[MAX_AXIS];
} ODBDGN_u;
/* Diagnosis data of one number. */
typedef struct { short datano, type; ODBDGN_u u; } ODBDGN;
/* A message to the operator; the text ends in a zero. */
typedef struct { short datano, type, char_num; text data[MSG_SIZE] __counted_by(char_num); } OPMSG;
/* Signals of the software operator's panel; `type` says which. */
typedef struct {
    short datano, type, mode, hndl_ax, hndl_mv, rpd_ovrd, jog_ovrd, feed_ovrd, spdl_ovrd, blck_del,
        sngl_blck, machn_lock, dry_run, mem_prtct, feed_hold;
} IODBSGNL;

#pragma pack(1)

/* General-purpose signals of the software operator's panel; `type` says which. */
typedef struct { short datano, type; unsigned char sgnal; } IODBGNRL;
/* Names of the general-purpose signals; `type` says which. */
typedef struct {
    short datano, type;
    text sgnl1_name[9], sgnl2_name[9], sgnl3_name[9], sgnl4_name[9], sgnl5_name[9], sgnl6_name[9],
        sgnl7_name[9], sgnl8_name[9];
} IODBRDNA;

#pragma pack(2)

/* Bytes, words or double words. */
typedef union { char cdata[PMC_ITEMS]; short idata[PMC_ITEMS]; long ldata[PMC_ITEMS]; } IODBPMC_u;
/* A range of PMC data. */
typedef struct { short type_a, type_d, datano_s, datano_e; IODBPMC_u u; } IODBPMC;
/* A range of PMC addresses; bit 7 of `adr_attr` forbids to write. */
typedef struct { unsigned char pmc_adr, adr_attr; unsigned short top_num, last_num; } PMCINF;
/* The ranges of PMC addresses. */
typedef struct { short datano; PMCINF info[64]; } ODBPMCINF;
