/* The structures of the APCI board's function library (Manual 002).

`text` is a char that is one of a text, `octet` a char whose bits count; __counted_by(n) says how many elements of an
array count, or how many bytes a pointer leads to. */

#define MAXAXIS 18
#define COMMON_VARIABLES 1000
/* Ruling: the manual names the constant without its value. */
#define SIZE_STRREV 80
/* The manual's example. */
#define ENVIRONMENT_STRING_BYTES 1024

typedef char text;
typedef long LONGINT;

#pragma pack(4)

/* Axis selection, table 2: `unoa` axes, whose numbers from 0 stand at the front of `san`. */
typedef struct { LONGINT unoa, san[MAXAXIS] __counted_by(unoa); } AS;
/* What is exchanged about one axis, table 3.. */
typedef struct {
    LONGINT an;
    double kp, ki, kd, kpl, kfca, kfcv, jac, jvl, jtv, jovr, hac, hvl, rp, dp, tp, sll, slr, ipw, mpe, gf;
    LONGINT mcp, axst, lsm, epc, digi, digo, ifs, scratch[4];
} TSRP;
/* What functions use and no table has: no part of the memory. */
typedef struct { double aux, lp, dv, sdec; } TSRP_beside;
/* Units of interpolation, table 4: indices of the position and the time unit. */
typedef struct { LONGINT pu, tu; } TRU;
/* Parameters of a linear interpolation, table 5; `dtm` is indexed by axis number. */
typedef struct { double ac, vl, tvl, dtm[MAXAXIS]; } LMP;
/* Parameters of a circular interpolation, table 6; `phi` in degrees, positive anti-clockwise. */
typedef struct { double ac, vl, tvl, phi, dtca1, dtca2; } CMP;
/* Parameters of a helical interpolation, table 7. */
typedef struct { double ac, vl, tvl, phi, dtca1, dtca2, dtm[MAXAXIS]; } HMP;
/* Parameters of a circle in space, table 8; `pn1` to `pn3` are normal to its plane, `dtm` is not used. */
typedef struct { double ac, vl, tvl, phi, dtca1, dtca2, dtca3, pn1, pn2, pn3, dtm[MAXAXIS]; } HMP3D;
/* What the board says about its operating system, table 9; all zero if it does not answer. */
typedef struct { text revision[SIZE_STRREV]; LONGINT number_axis, sysfile_loaded; } ROSI;
/* A transfer of a CNC task's common buffer, table 10. */
typedef struct { LONGINT task_number, size; void *buffer __counted_by(size); } CBCNCT;
/* State of a CNC task, table 11; for the bits of `running` see `Running`. */
typedef struct { LONGINT errnum, errline, stackfree, running, csrcline; } CNCTS;
/* What lpr and lprs record. Only the element `san`, the axis of lpr, is known. */
typedef struct { LONGINT san; } LATCH_INFOS;
/* The common double variables CD0 to CD999. */
typedef struct { double cd[COMMON_VARIABLES]; } CDBUF;
/* The common integer variables CI0 to CI999. */
typedef struct { LONGINT ci[COMMON_VARIABLES]; } CIBUF;
/* Setpoints for spd, spda and spdr, which say how many. */
typedef struct { double position[COMMON_VARIABLES]; } SPDBUF;
/* The parameter field of scp, 15 rows of 15. */
typedef struct { double parameters[15][15]; } CTRLPARAMS;
/* The in and out text of getEnvStr: a name goes in, its value comes out. */
typedef struct { text text[ENVIRONMENT_STRING_BYTES]; } CppString;
