/* Runs a contour of an iMC card's first path: lines of two axes, one after the other without a stop. */
#include <stdio.h>
#include <string.h>

#include "IMCnet.h"

#define ONE 65536 /* 1 in S16.16: velocities are pulses per millisecond */

static IMC_HANDLE card;

/* Say what a call answers that is not IMC_OK, and count it. */
static int wrong(const char *what, IMC_STATUS status)
{
    if (status != IMC_OK)
        printf("%s %d\n", what, status);
    return status != IMC_OK;
}

static IMC32 position(IMC32 axis)
{
    IMC32 at = 0;
    wrong("position", IMC_GetParam32(card, curposLoc, &at, axis));
    return at;
}

/* Make a path of the axes 0 and 1, in absolute positions. */
static int begin(void)
{
    int failed = 0, axis;
    for (axis = 0; axis < 2; axis++)
        failed += wrong("absolute", IMC_SetParam16(card, pathabsLoc, -1, axis, SEL_IFIFO));
    failed += wrong("x", IMC_SetParam16(card, segmap_x1Loc, 0, 0, SEL_IFIFO));
    failed += wrong("y", IMC_SetParam16(card, segmap_y1Loc, 1, 0, SEL_IFIFO));
    failed += wrong("acceleration", IMC_SetParam32(card, pathacc1Loc, ONE / 2, 0, SEL_IFIFO));
    failed += wrong("feed", IMC_SetParam32(card, feedrate1Loc, ONE, 0, SEL_IFIFO));
    failed += wrong("velocity", IMC_SetParam32(card, segtgvel1Loc, 20 * ONE, 0, SEL_IFIFO));
    failed += wrong("end", IMC_SetParam32(card, segendvel1Loc, 20 * ONE, 0, SEL_IFIFO));
    failed += wrong("start", IMC_SetParam16(card, startpath1Loc, -1, 0, SEL_IFIFO));
    return failed;
}

int main(void)
{
    static const IMC32 corners[4][2] = {{4000, 0}, {8000, 100}, {8000, 6000}, {3000, 6000}};
    PFIFOSegData line;
    WR_MUL_DES error;
    IMC_STATUS status = IMC_Open(&card, 0, 0);
    int failed, k, left = 100000;

    printf("open %d\n", status);
    if (status != IMC_OK)
        return 1;
    failed = begin();
    for (k = 0; k < 4; k++) {
        memset(&line, 0, sizeof line);
        line.datanum = 2;
        line.SegEndData[0] = corners[k][0];
        line.SegEndData[1] = corners[k][1];
        failed += wrong("line", IMC_AddLineN(card, &line, SEL_PFIFO1));
    }
    while (!failed && left-- && (position(0) != 3000 || position(1) != 6000))
        ;
    printf("at %d %d\n", (int)position(0), (int)position(1));
    memset(&error, 0, sizeof error);
    error.addr = errorLoc;
    error.len = 1;
    failed += wrong("error", IMC_GetMulParam(card, &error, 1));
    printf("errors %d\n", error.data[0]);
    printf("close %d\n", IMC_Close(card));
    return failed;
}
