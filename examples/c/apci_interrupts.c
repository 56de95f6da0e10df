/* Drills three holes with an APCI board whose spooler interrupts the PC where the second one begins. */
#include <stdio.h>
#include <string.h>

#include "mcug3.h"

#define PROFILE_END 13
#define INTERRUPT 1101
#define PATIENCE 20000

static TSRP tsrp[MAXAXIS];
static AS table;
static volatile int called, lines_seen, requested, finished, during;

/* Counts the calls of the main thread that have been finished. */
#define CALL(x) ((x), finished++)

static void PC_CALL routine(int lines)
{
    int k, before = finished;
    lines_seen = lines;
    for (k = 0; k < 50; k++)
        requested = rdirqpc(); /* a routine may call the board itself; other calls wait meanwhile */
    during = finished - before;
    called++;
}

static void spool(double x, double y)
{
    LMP lmp;
    memset(&lmp, 0, sizeof lmp);
    lmp.ac = 500.0;
    lmp.vl = 80.0;
    lmp.dtm[0] = x;
    lmp.dtm[1] = y;
    CALL(smla(&table, &lmp));
}

int main(void)
{
    static const double holes[3][2] = {{12.5, 4.0}, {25.0, 8.5}, {37.5, 4.25}};
    ROSI rosi;
    int type = 0, k, left = PATIENCE, code = InitMcuSystem3(tsrp, &rosi, 0, "system.dat", &type), state = 0;

    printf("init %d\n", code);
    if (code)
        return 1;
    table.unoa = 2;
    table.san[1] = 1;
    printf("install %d\n", MCUG3_SetBoardIntRoutine(routine));
    CALL(cl(&table));
    for (k = 0; k < 3; k++) {
        if (k == 1)
            CALL(ssf(0, INTERRUPT, 0.0));
        spool(holes[k][0], holes[k][1]);
    }
    CALL(ssms(&table));
    while (!state && left--)
        CALL(state = rdaxstb(0, PROFILE_END) && rdaxstb(1, PROFILE_END));
    for (left = PATIENCE; !called && left; left--) /* the request stays until a program of the board takes it back */
        CALL(rdirqpc());
    for (k = 0; k < 2; k++)
        rddp(&tsrp[k]);
    printf("at %.3f %.3f\n", tsrp[0].dp, tsrp[1].dp);
    printf("called %d, lines %d, requested %d\n", called, lines_seen, requested);
    printf("other calls meanwhile: %s\n", during <= 1 ? "none" : "some"); /* one may just have been finished */
    printf("remove %d\n", MCUG3_ResetBoardIntRoutine());
    return 0;
}
