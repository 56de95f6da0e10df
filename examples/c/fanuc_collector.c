/* Collects from a FANUC control: a sample for each line that it reads; what is lost is opened anew with the next one.

   fanuc_collector HOST PORT */
#include <stdio.h>
#include <stdlib.h>

#include "fwlib32.h"

static unsigned short handle;
static int is_open;

/* Close what a failure has left, and open the control. */
static short reconnect(char *host, unsigned short port)
{
    short code;
    if (is_open)
        cnc_freelibhndl(handle);
    code = cnc_allclibhndl3(host, port, 2, &handle);
    is_open = code == EW_OK;
    return code;
}

/* Read state, program and positions; the first code that is not EW_OK. */
static short sample(int number)
{
    ODBST state;
    ODBPRO program;
    ODBAXIS at;
    ODBACT feed;
    ODBALM alarms;
    short code;
    if ((code = cnc_statinfo(handle, &state)) != EW_OK)
        return code;
    if ((code = cnc_rdprgnum(handle, &program)) != EW_OK)
        return code;
    if ((code = cnc_absolute(handle, ALL_AXES, 4 + 4 * MAX_AXIS, &at)) != EW_OK)
        return code;
    if ((code = cnc_actf(handle, &feed)) != EW_OK)
        return code;
    if ((code = cnc_alarm(handle, &alarms)) != EW_OK)
        return code;
    printf("%d: mode %d, run %d, program %d, at %d %d, feed %d, alarms %d\n", number, state.aut, state.run,
           (int)program.data, (int)at.data[0], (int)at.data[1], (int)feed.data, (int)alarms.data);
    return EW_OK;
}

int main(int count, char **given)
{
    char line[80];
    int number = 0;
    short code;
    if (count != 3)
        return 2;
    setvbuf(stdout, NULL, _IOLBF, 400);
    while (fgets(line, sizeof line, stdin)) {
        if (!is_open) {
            code = reconnect(given[1], (unsigned short)atoi(given[2]));
            printf("open %d\n", code);
            if (code != EW_OK)
                continue;
        }
        code = sample(++number);
        if (code != EW_OK) {
            printf("%d: lost, %d\n", number, code);
            cnc_freelibhndl(handle);
            is_open = 0;
        }
    }
    if (is_open)
        printf("free %d\n", cnc_freelibhndl(handle));
    return 0;
}
