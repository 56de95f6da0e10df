/* Loads the library of the iMC card by its name while it runs, opens a card and reads where its axis 0 is. */
#include <stdio.h>
#include <string.h>

#include "IMCnet.h"

#ifdef _WIN32
#include <windows.h>
static void *find(const char *name)
{
    static HMODULE library;
    FARPROC found;
    void *made;
    if (!library)
        library = LoadLibraryA("IMCnet.dll");
    found = library ? GetProcAddress(library, name) : NULL;
    memcpy(&made, &found, sizeof made);
    return made;
}
#else
#include <dlfcn.h>
static void *find(const char *name)
{
    static void *library;
    if (!library)
        library = dlopen("libIMCnet.so", RTLD_NOW);
    return library ? dlsym(library, name) : NULL;
}
#endif

typedef IMC_STATUS(PC_CALL *Open)(IMC_HANDLE *, int, int);
typedef IMC_STATUS(PC_CALL *GetParam32)(IMC_HANDLE, IMC16, PVOID, IMC32);
typedef IMC_STATUS(PC_CALL *Close)(IMC_HANDLE);

int main(void)
{
    void *found[3];
    Open open_card;
    GetParam32 read;
    Close close_card;
    IMC_HANDLE card;
    IMC32 at = -1;
    IMC_STATUS status;

    found[0] = find("IMC_Open");
    found[1] = find("IMC_GetParam32");
    found[2] = find("IMC_Close");
    printf("found %d\n", found[0] && found[1] && found[2]);
    if (!found[0] || !found[1] || !found[2])
        return 1;
    memcpy(&open_card, &found[0], sizeof open_card);
    memcpy(&read, &found[1], sizeof read);
    memcpy(&close_card, &found[2], sizeof close_card);
    printf("open %d\n", status = open_card(&card, 0, 0));
    if (status)
        return 1;
    status = read(card, curposLoc, &at, 1);
    printf("axis 1 %d: %d\n", status, (int)at);
    printf("close %d\n", close_card(card));
    return 0;
}
