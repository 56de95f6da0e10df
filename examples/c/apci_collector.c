/* Collects from an APCI board: a sample for each line that it reads; a board that is lost is initialised anew with the next
   one. */
#include <stdio.h>

#include "mcug3.h"

#define AXES 3

static TSRP tsrp[MAXAXIS];
static int is_open;

/* Initialise the system, which also finds a board that was lost. */
static int connect_board(void)
{
    ROSI rosi;
    int type = 0, k, code = InitMcuSystem3(tsrp, &rosi, 0, "system.dat", &type);
    is_open = code == 0;
    for (k = 0; k < AXES; k++)
        tsrp[k].an = k;
    return code;
}

/* Read what there is to see; the code of the first call that says that the board is gone. */
static int sample(int number)
{
    double velocity = -1.0;
    PC_LONG errors = -1;
    int k, code = rdtrvl(&velocity);
    if (code < 0)
        return code;
    for (k = 0; k < AXES; k++) {
        rddp(&tsrp[k]);
        rdrp(&tsrp[k]);
    }
    rdErrorReg(&errors);
    printf("%d: at %.3f %.3f %.3f, real %.3f, velocity %.1f, errors %d\n", number, tsrp[0].dp, tsrp[1].dp, tsrp[2].dp,
           tsrp[0].rp, velocity, (int)errors);
    return 0;
}

int main(void)
{
    char line[80];
    int number = 0, code;
    setvbuf(stdout, NULL, _IOLBF, 400);
    while (fgets(line, sizeof line, stdin)) {
        if (!is_open) {
            code = connect_board();
            printf("init %d\n", code);
            if (code)
                continue;
        }
        code = sample(++number);
        if (code) {
            printf("%d: lost, %d\n", number, code);
            is_open = 0;
        }
    }
    return 0;
}
