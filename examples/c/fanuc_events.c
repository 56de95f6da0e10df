/* Watches a FANUC control for events: tells the state, messages and alarms when they change, and counts them in macros.

   fanuc_events SAMPLES */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fwlib32.h"

#define FIRST 500
#define LAST 502

static unsigned short handle;

/* Say what a call answers that is not EW_OK. */
static int wrong(const char *what, short code)
{
    if (code != EW_OK)
        printf("%s %d\n", what, code);
    return code != EW_OK;
}

/* Write how many samples, changes and alarms there were to a range of macro variables, and read it back. */
static int keep(const int *counts)
{
    IODBMR range;
    short length = 6 + 6 * (LAST - FIRST + 1);
    int k;
    memset(&range, 0, sizeof range);
    range.datano_s = FIRST;
    range.datano_e = LAST;
    for (k = 0; k <= LAST - FIRST; k++)
        range.data[k].mcr_val = counts[k];
    if (wrong("write", cnc_wrmacror(handle, length, &range)))
        return 1;
    memset(&range, 0, sizeof range);
    if (wrong("read", cnc_rdmacror(handle, FIRST, LAST, length, &range)))
        return 1;
    for (k = 0; k <= LAST - FIRST; k++)
        printf("#%d = %d.%d\n", FIRST + k, (int)range.data[k].mcr_val, range.data[k].dec_val);
    return 0;
}

int main(int count, char **given)
{
    ODBST state, before;
    ODBALM alarms;
    OPMSG message;
    ODBAXIS at;
    int counts[3] = {0, 0, 0}, left = count > 1 ? atoi(given[1]) : 3;

    if (wrong("open", cnc_allclibhndl(&handle)))
        return 1;
    memset(&before, -1, sizeof before);
    while (left--) {
        if (wrong("state", cnc_statinfo(handle, &state)) || wrong("alarm", cnc_alarm(handle, &alarms)))
            break;
        if (wrong("message", cnc_rdopmsg(handle, 0, sizeof message, &message)))
            break;
        counts[0]++;
        counts[2] += alarms.data != 0;
        if (memcmp(&state, &before, sizeof state)) {
            counts[1]++;
            printf("mode %d, run %d, motion %d, emergency %d, alarm %d\n", state.aut, state.run, state.motion,
                   state.emergency, state.alarm);
            if (message.datano != -1)
                printf("message %d: %.*s\n", message.datano, message.char_num, message.data);
        }
        before = state;
    }
    if (keep(counts))
        return 1;
    /* what a careless collector passes is refused, and changes nothing */
    printf("too short %d\n", cnc_absolute(handle, ALL_AXES, 5, &at));
    printf("free %d\n", cnc_freelibhndl(handle));
    printf("free again %d\n", cnc_freelibhndl(handle));
    return 0;
}
