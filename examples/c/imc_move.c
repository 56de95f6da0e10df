/* Opens an iMC card, moves its axis 0 by 6250 pulses and waits until it stands. */
#include <stdio.h>

#include "IMCnet.h"

int main(void)
{
    NIC_INFO adapters;
    IMC_HANDLE card;
    int found = 0, left = 2000000;
    IMC16 moving = 1;
    IMC32 at = 0;
    IMC_STATUS status = IMC_FindNetCard(&adapters, &found);

    printf("adapters %d: %d\n", status, found);
    status = IMC_Open(&card, 0, 0);
    printf("open %d\n", status);
    if (status)
        return 1;
    printf("move %d\n", IMC_MoveAbsolute(card, 6250, 0, SEL_QFIFO));
    do
        status = IMC_GetParam32(card, curposLoc, &at, 0);
    while (!status && at != 6250 && --left);
    do
        status = IMC_GetParam16(card, movingLoc, &moving, 0);
    while (!status && moving && --left);
    printf("at %d, moving %d\n", (int)at, moving);
    printf("close %d\n", IMC_Close(card));
    return 0;
}
