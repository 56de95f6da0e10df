/* Homes the two axes of a gantry on an iMC card by switch and index, then follows a contour of lines and an arc of its first
   path without a stop. The card has origin switches: see ../imc_gantry.toml. */
#include <stdio.h>
#include <string.h>

#include "IMCnet.h"

#define ONE 65536 /* 1 in S16.16: velocities are pulses per millisecond */
#define AXES 2
#define FORWARD 0
#define RISING 1
#define STOP_THERE 0

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

static int home(void)
{
    IMC16 homed;
    IMC32 axis;
    int failed = 0, count = 0;
    long left = 2000000;
    for (axis = 0; axis < AXES; axis++)
        failed += wrong("home", IMC_HomeSwitchIndex1(card, FORWARD, RISING, STOP_THERE, axis, SEL_IFIFO));
    for (axis = 0; axis < AXES; axis++) {
        do {
            homed = 0;
            failed += wrong("homed", IMC_GetParam16(card, homedLoc, &homed, axis));
        } while (!failed && !homed && --left);
        count += homed != 0;
    }
    printf("homed %d axes\n", count);
    return failed || count != AXES;
}

/* Make a path of both axes, in absolute positions. */
static int begin(void)
{
    int failed = 0, axis;
    for (axis = 0; axis < AXES; axis++)
        failed += wrong("absolute", IMC_SetParam16(card, pathabsLoc, -1, axis, SEL_IFIFO));
    failed += wrong("x", IMC_SetParam16(card, segmap_x1Loc, 0, 0, SEL_IFIFO));
    failed += wrong("y", IMC_SetParam16(card, segmap_y1Loc, 1, 0, SEL_IFIFO));
    failed += wrong("acceleration", IMC_SetParam32(card, pathacc1Loc, ONE / 2, 0, SEL_IFIFO));
    failed += wrong("feed", IMC_SetParam32(card, feedrate1Loc, ONE, 0, SEL_IFIFO));
    failed += wrong("velocity", IMC_SetParam32(card, segtgvel1Loc, 20 * ONE, 0, SEL_IFIFO));
    failed += wrong("end", IMC_SetParam32(card, segendvel1Loc, 20 * ONE, 0, SEL_IFIFO));
    return failed + wrong("start", IMC_SetParam16(card, startpath1Loc, -1, 0, SEL_IFIFO));
}

static int line(IMC32 x, IMC32 y)
{
    PFIFOSegData to;
    memset(&to, 0, sizeof to);
    to.datanum = AXES;
    to.SegEndData[0] = x;
    to.SegEndData[1] = y;
    return wrong("line", IMC_AddLineN(card, &to, SEL_PFIFO1));
}

int main(void)
{
    IMC_STATUS status = IMC_Open(&card, 0, 0);
    int failed;
    long left = 2000000;

    printf("open %d\n", status);
    if (status != IMC_OK)
        return 1;
    failed = home() || begin();
    if (!failed) {
        failed += line(4000, 0) + line(8000, 100) + line(12000, 0);
        failed += wrong("arc", IMC_AddArc(card, 12000, 6000, 12000, 3000, 1, SEL_PFIFO1));
        failed += line(2000, 6000);
        while (!failed && (position(0) != 2000 || position(1) != 6000) && --left)
            ;
    }
    printf("at %d %d\n", (int)position(0), (int)position(1));
    printf("close %d\n", IMC_Close(card));
    return failed;
}
