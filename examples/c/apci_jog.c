/* Closes the loop of an axis of the APCI board, jogs it to 12.5 mm and waits until it is there. */
#include <stdio.h>
#include <string.h>

#include "mcug3.h"

int main(void)
{
    TSRP tsrp[MAXAXIS];
    ROSI rosi;
    AS as;
    PC_LONG left = 2000000;
    int type = 0, code;

    memset(tsrp, 0, sizeof tsrp);
    memset(&as, 0, sizeof as);
    code = InitMcuSystem3(tsrp, &rosi, 0, "system.dat", &type);
    printf("init %d, board %d, %d axes\n", code, type, (int)rosi.number_axis);
    if (code)
        return 1;
    as.unoa = 1;
    as.san[0] = 0;
    cl(&as);
    tsrp[0].tp = 12.5;
    ja(&as, tsrp);
    while (!rdaxstb(0, 13) && left)
        left--;
    rddp(&tsrp[0]);
    printf("at %.3f\n", tsrp[0].dp);
    return 0;
}
