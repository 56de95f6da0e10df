/* Writes a custom macro variable and reads it, the positions and a parameter of a FANUC control. */
#include <stdio.h>

#include "fwlib32.h"

int main(void)
{
    unsigned short handle;
    ODBAXIS at;
    ODBM macro;
    IODBPSD parameter;
    short code = cnc_allclibhndl(&handle);

    printf("open %d\n", code);
    if (code)
        return 1;
    printf("write %d\n", cnc_wrmacro(handle, 103, 10, 271828, 5));
    code = cnc_rdmacro(handle, 103, sizeof macro, &macro);
    printf("macro %d: %d %d\n", code, (int)macro.mcr_val, macro.dec_val);
    code = cnc_absolute(handle, ALL_AXES, 4 + 4 * 3, &at);
    printf("position %d: %d %d %d\n", code, (int)at.data[0], (int)at.data[1], (int)at.data[2]);
    printf("too short %d\n", cnc_absolute(handle, ALL_AXES, 4 + 4 * 3 - 1, &at));
    code = cnc_rdparam(handle, 1420, 1, 8, &parameter);
    printf("parameter %d: %d\n", code, (int)parameter.u.ldata);
    printf("free %d\n", cnc_freelibhndl(handle));
    return 0;
}
