/* The structures of the iMC card's function library (Manual 004, 6).

`text` is a char that is one of a text, `octet` a char whose bits count; __counted_by(n) says how many elements of an
array count, or how many bytes a pointer leads to. */

#define ADAPTERS_MOST 16
#define DESCRIPTION_SIZE 256
#define SEGMENT_AXES_MOST 16

typedef char text;
typedef unsigned short WORD;
typedef short IMC16;
typedef long IMC32;

#pragma pack()

/* The network adapters of the PC: up to 16 descriptions; the index of one is the `netcardsel` of a call. */
typedef struct { text description[ADAPTERS_MOST][DESCRIPTION_SIZE]; } NIC_INFO;
/* One parameter of several that are read or written together: `len` words, the low one first. */
typedef struct { WORD addr, axis, len, data[4] __counted_by(len); } WR_MUL_DES;
/* Second operand of an event: a parameter. */
typedef struct { IMC16 Src2_loc, Src2_axis; IMC32 reserve; } Src2Param;
/* Second operand of an event: a constant of 16 bits. */
typedef struct { IMC16 data, reserve1; IMC32 reserve2; } Src2Data16;
/* Second operand of an event: a constant of 32 bits. */
typedef struct { IMC32 data, reserve; } Src2Data32;
/* Second operand of an event; the command says which member counts. */
typedef union { Src2Param param; Src2Data16 data16; Src2Data32 data32; __int64 data48; } Operand2;
/* One event: a command, when it acts, two operands, and where the result goes (0: nowhere). */
typedef struct {
    IMC16 EventCMD, EventType, Src1_loc, Src1_axis;
    Operand2 Src2;
    IMC16 dest_loc, dest_axis;
    IMC32 reserve;
} EventInfo;
/* A segment: where the axes end, and for an arc its centre and direction (0 clockwise, -1 counter-clockwise). */
typedef struct {
    IMC32 datanum, SegEndData[SEGMENT_AXES_MOST] __counted_by(datanum), CenterX, CenterY, dir;
} PFIFOSegData;
/* A segment with its speed and the speed at its end. */
typedef struct { IMC32 SegTgVel, SegEndVel; PFIFOSegData data; } PFIFOSegInfo;
