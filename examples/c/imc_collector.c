/* Collects from an iMC card: a sample for each line that it reads; a card that is lost is closed, and opened anew with the
   next one. */
#include <stdio.h>
#include <string.h>

#include "IMCnet.h"

#define AXES 2

static IMC_HANDLE card;
static int is_open;

static IMC_STATUS reconnect(void)
{
    IMC_STATUS status;
    if (card)
        IMC_Close(card);
    card = NULL;
    status = IMC_Open(&card, 0, 0);
    is_open = status == IMC_OK;
    return status;
}

/* Read what there is to see in one call; the first status that is not IMC_OK. */
static IMC_STATUS sample(int number)
{
    static const IMC16 places[3] = {curposLoc, encpLoc, errorLoc};
    WR_MUL_DES what[3 * AXES];
    IMC32 at[2 * AXES];
    IMC_STATUS status;
    int k;
    memset(what, 0, sizeof what);
    for (k = 0; k < 3 * AXES; k++) {
        what[k].addr = (WORD)places[k / AXES];
        what[k].axis = (WORD)(k % AXES);
        what[k].len = k < 2 * AXES ? 2 : 1;
    }
    status = IMC_GetMulParam(card, what, 3 * AXES);
    if (status != IMC_OK)
        return status;
    for (k = 0; k < 2 * AXES; k++)
        memcpy(&at[k], what[k].data, sizeof at[k]);
    printf("%d: at %d %d, encoders %d %d, errors %d %d\n", number, (int)at[0], (int)at[1], (int)at[2], (int)at[3],
           what[4].data[0], what[5].data[0]);
    return IMC_OK;
}

int main(void)
{
    char line[80];
    int number = 0;
    IMC_STATUS status;
    setvbuf(stdout, NULL, _IOLBF, 400);
    while (fgets(line, sizeof line, stdin)) {
        if (!is_open) {
            status = reconnect();
            printf("open %d\n", status);
            if (status != IMC_OK)
                continue;
        }
        status = sample(++number);
        if (status != IMC_OK) {
            printf("%d: lost, %d\n", number, status);
            is_open = 0;
        }
    }
    if (is_open)
        printf("close %d\n", IMC_Close(card));
    return 0;
}
