/* Homes two axes of a FANUC control that a PC commands directly, then follows a contour: while one line is executed the next
   one waits in the control's second buffer. */
#include <stdio.h>
#include <stdlib.h>

#include "fwlib32.h"

#define PATH 1
#define AXES 2
#define FEED 6000 /* mm/min */

static unsigned short handle;

/* Say what a call answers that is not EW_OK. */
static int wrong(const char *what, short code)
{
    if (code != EW_OK)
        printf("%s %d\n", what, code);
    return code != EW_OK;
}

/* Wait until both buffers of the path are empty. */
static int wait_for_rest(void)
{
    ODBEXEC buffers;
    long left = 2000000;
    do
        if (wrong("buffers", cnc_exebufstat(handle, &buffers)))
            return 1;
    while ((buffers.cdata[0][PATH - 1] || buffers.cdata[1][PATH - 1]) && --left);
    return !left;
}

/* Command a line to a point in micrometres as soon as a buffer takes it; how often both were full. */
static int line(PC_LONG x, PC_LONG y, int *waited)
{
    ODBPOS to[AXES];
    ODBEXEC buffers;
    short code;
    long left = 2000000;
    to[0].idata = 1;
    to[0].ldata = x;
    to[1].idata = 2;
    to[1].ldata = y;
    while ((code = cnc_abspoint(handle, PATH, 0, AXES, FEED, to, &buffers)) == EW_BUSY && --left)
        *waited = 1;
    return wrong("line", code);
}

static int home(void)
{
    ODBEXEC buffers;
    short axis;
    int waited = 0;
    if (line(7000, 4000, &waited) || wait_for_rest())
        return 1;
    for (axis = 1; axis <= AXES; axis++)
        if (wrong("home", cnc_refpoint(handle, PATH, 0, axis, &buffers)) || wait_for_rest())
            return 1;
    return 0;
}

static int say_where(const char *when)
{
    ODBAXIS at;
    if (wrong("position", cnc_machine(handle, ALL_AXES, 4 + 4 * MAX_AXIS, &at)))
        return 1;
    printf("%s %d %d\n", when, (int)at.data[0], (int)at.data[1]);
    return 0;
}

int main(void)
{
    static const PC_LONG corners[6][2] = {{10000, 0}, {20000, 500}, {30000, 0}, {30000, 20000}, {15000, 21000}, {5000, 20000}};
    int k, waited = 0;
    short code = cnc_allclibhndl(&handle);

    printf("open %d\n", code);
    if (code)
        return 1;
    if (home() || say_where("home"))
        return 1;
    for (k = 0; k < 6; k++)
        if (line(corners[k][0], corners[k][1], &waited))
            return 1;
    if (wait_for_rest() || say_where("at"))
        return 1;
    printf("waited for a buffer %d\n", waited);
    printf("free %d\n", cnc_freelibhndl(handle));
    return 0;
}
