/* An electronic line shaft on an iMC card: slaves follow a master, and an event couples a cutter when it passes 12000. */
#include <stdio.h>
#include <string.h>

#include "IMCnet.h"

#define ONE 65536 /* 1 in S16.16: velocities are pulses per millisecond */
#define CUTTER 3

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

static IMC32 velocity(IMC32 axis)
{
    IMC32 now = 0;
    wrong("velocity", IMC_GetParam32(card, curvelLoc, &now, axis));
    return now / ONE;
}

static void wait_for_rest(IMC32 axes)
{
    IMC16 moving;
    IMC32 axis;
    long left = 20000000;
    for (axis = 0; axis < axes; axis++)
        do {
            moving = 0;
            wrong("moving", IMC_GetParam16(card, movingLoc, &moving, axis));
        } while (moving && --left);
}

static int install(void)
{
    EventInfo events[2];
    memset(events, 0, sizeof events);
    events[0].EventCMD = CMD_CMP32i; /* the master's position with 12000 */
    events[0].Src1_loc = curposLoc;
    events[0].Src1_axis = 0;
    events[0].Src2.data32.data = 12000;
    events[1].EventCMD = CMD_SET16; /* once it is reached, the cutter begins */
    events[1].EventType = IMC_Edge_GreatEqu;
    events[1].Src2.data16.data = -1;
    events[1].dest_loc = startsynLoc;
    events[1].dest_axis = CUTTER;
    return wrong("events", IMC_InstallEvent(card, events, 2, SEL_IFIFO));
}

int main(void)
{
    IMC_STATUS status = IMC_Open(&card, 0, 0);
    int failed = 0;

    printf("open %d\n", status);
    if (status != IMC_OK)
        return 1;
    failed += wrong("gear", IMC_GearFree(card, 0.5, 0, 0, 1, SEL_IFIFO));
    failed += wrong("gear", IMC_GearFree(card, -1.0, 0, 0, 2, SEL_IFIFO));
    failed += wrong("gear", IMC_GearInDist(card, 1.0, 0, 0, 0, 0, 4000, CUTTER, SEL_IFIFO));
    failed += install();
    failed += wrong("move", IMC_MoveVelocity(card, 20 * ONE, 0, SEL_IFIFO));
    while (!failed && position(0) < 11000)
        ;
    printf("before: the cutter is at %d\n", (int)position(CUTTER));
    while (!failed && velocity(CUTTER) < 20)
        ;
    printf("after: the cutter runs as the master: %d\n", velocity(CUTTER) == velocity(0));
    failed += wrong("stop", IMC_MoveVelocity(card, 0, 0, SEL_IFIFO));
    wait_for_rest(4);
    printf("slaves by the master: %.2f %.2f\n", (double)position(1) / position(0), (double)position(2) / position(0));
    printf("close %d\n", IMC_Close(card));
    return failed;
}
