/* Homes the axes of a gantry on the APCI board, then runs a contour of lines and an arc from its spooler. */
#include <stdio.h>
#include <string.h>

#include "mcug3.h"

#define PROFILE_END 13
#define REFERENCED 18
#define AXES 3

static TSRP tsrp[MAXAXIS];
static AS all, plane;

static void select_axes(AS *as, int count)
{
    int k;
    memset(as, 0, sizeof *as);
    as->unoa = count;
    for (k = 0; k < count; k++)
        as->san[k] = k;
}

static void wait_for_rest(void)
{
    int k, left = 20000000;
    for (k = 0; k < AXES; k++)
        while (!rdaxstb(k, PROFILE_END) && left)
            left--;
}

static void home(void)
{
    int k, homed = 0;
    cl(&all);
    jhl(&all); /* to the left, onto the reference switches */
    wait_for_rest();
    for (k = 0; k < AXES; k++)
        tsrp[k].tp = 15.0;
    jhi(&all, tsrp); /* to the right, to the next index pulse */
    wait_for_rest();
    for (k = 0; k < AXES; k++) {
        tsrp[k].tp = 0.0;
        shp(&tsrp[k]);
        homed += rdaxstb(k, REFERENCED) != 0;
    }
    printf("homed %d axes\n", homed);
}

static void line(double x, double y)
{
    LMP lmp;
    memset(&lmp, 0, sizeof lmp);
    lmp.ac = 400.0;
    lmp.vl = 60.0;
    lmp.tvl = 60.0; /* goes on into the next one */
    lmp.dtm[0] = x;
    lmp.dtm[1] = y;
    smla(&plane, &lmp);
}

static void arc(double degrees, double x, double y)
{
    CMP cmp;
    memset(&cmp, 0, sizeof cmp);
    cmp.ac = 400.0;
    cmp.vl = 60.0;
    cmp.phi = degrees;
    cmp.dtca1 = x;
    cmp.dtca2 = y;
    smca(&plane, &cmp);
}

int main(void)
{
    ROSI rosi;
    int type = 0, k, code = InitMcuSystem3(tsrp, &rosi, 0, "system.dat", &type);
    PC_LONG errors = -1;

    printf("init %d, %d axes\n", code, (int)rosi.number_axis);
    if (code)
        return 1;
    select_axes(&all, AXES);
    select_axes(&plane, 2);
    home();
    line(20.0, 0.0);
    line(40.0, 0.2);
    line(60.0, 0.0);
    arc(180.0, 60.0, 25.0);
    ssms(&plane);
    wait_for_rest();
    for (k = 0; k < AXES; k++)
        rddp(&tsrp[k]);
    printf("at %.3f %.3f %.3f\n", tsrp[0].dp, tsrp[1].dp, tsrp[2].dp);
    rdErrorReg(&errors);
    printf("errors %d\n", (int)errors);
    return 0;
}
