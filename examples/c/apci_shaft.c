/* A line shaft on the APCI board, by jogs: the second axis is sent along with the first, and events are told by their bits. */
#include <stdio.h>
#include <string.h>

#include "mcug3.h"

#define PROFILE_END 13
#define AXES 2

static TSRP tsrp[MAXAXIS];
static AS shaft;

/* Send both axes by relative distances; the ratio of the slave is that of the distances, velocities and accelerations. */
static void turn(double distance, double ratio)
{
    int k;
    for (k = 0; k < AXES; k++) {
        double share = k ? ratio : 1.0;
        tsrp[k].tp = distance * share;
        tsrp[k].jvl = 50.0 * share;
        tsrp[k].jac = 400.0 * share;
        wrjvl(&tsrp[k]);
        wrjac(&tsrp[k]);
    }
    jr(&shaft, tsrp);
}

/* Wait until the axes are at rest; how often the master passed a mark meanwhile. */
static int wait_and_count(double mark)
{
    int passed = 0, below, was_below, left = 2000000;
    rddp(&tsrp[0]);
    was_below = tsrp[0].dp < mark;
    do {
        rddp(&tsrp[0]);
        below = tsrp[0].dp < mark;
        passed += below != was_below;
        was_below = below;
    } while (!(rdaxstb(0, PROFILE_END) && rdaxstb(1, PROFILE_END)) && --left);
    return passed;
}

int main(void)
{
    static const double turns[3][2] = {{20.0, 0.5}, {10.0, 0.25}, {-25.0, 0.4}};
    ROSI rosi;
    int type = 0, k, passed, code = InitMcuSystem3(tsrp, &rosi, 0, "system.dat", &type);
    PC_LONG errors = -1;

    printf("init %d\n", code);
    if (code)
        return 1;
    shaft.unoa = AXES;
    shaft.san[1] = 1;
    cl(&shaft);
    for (k = 0; k < AXES; k++) {
        tsrp[k].an = k;
        tsrp[k].tp = 0.0;
        shp(&tsrp[k]);
    }
    for (k = 0; k < 3; k++) {
        turn(turns[k][0], turns[k][1]);
        passed = wait_and_count(12.0);
        rddp(&tsrp[0]);
        rddp(&tsrp[1]);
        printf("turn %d: at %.3f %.3f, mark passed %d times\n", k + 1, tsrp[0].dp, tsrp[1].dp, passed);
    }
    rdErrorReg(&errors);
    printf("errors %d\n", (int)errors);
    return 0;
}
