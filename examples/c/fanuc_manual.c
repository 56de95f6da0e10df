/* What the samples of the manual do, one after another, on a control that is otherwise left alone: programs in pieces and by a
   small buffer, the directory, offsets, parameters, macro variables, the PMC, alarms, the state of the control. */
#include <stdio.h>
#include <string.h>

#include "fwlib32.h"

#define TOOLS 99
#define RANGE(count) (6 + sizeof(((IODBMR *)0)->data[0]) * (count)) /* bytes of a range of macro variables */

static unsigned short handle;

/* Say what a call answers. */
static void say(const char *what, short code)
{
    printf("%s %d", what, code);
}

static short send_pieces(const char *const *pieces, int count)
{
    short code = cnc_dwnstart(handle), ended;
    int k;
    for (k = 0; k < count && !code; k++)
        code = cnc_download(handle, pieces[k], (short)strlen(pieces[k]));
    ended = cnc_dwnend(handle);
    return code ? code : ended;
}

/* Say a text with a bar for the end of a line. */
static void say_lines(const char *text, int count)
{
    int k;
    for (k = 0; k < count && text[k]; k++)
        putchar(text[k] == '\n' ? '|' : text[k]);
}

/* Read a program by so many characters at a time, each piece in brackets with its length. */
static void receive(short number, short most)
{
    ODBUP buffer;
    unsigned short count;
    short code = cnc_upstart(handle, number);
    say("upload", code);
    do {
        count = (unsigned short)most;
        code = cnc_upload(handle, &buffer, &count);
        printf(" %d[", count);
        say_lines(buffer.data, code ? 0 : count);
        printf("]");
    } while (!code && count && buffer.data[count - 1] != '%');
    say(" end", cnc_upend(handle));
    printf("\n");
}

static void programs(void)
{
    static const char *const first[] = {"\n",       "O1234\n", "M3 S1200\n", "G0 Z0\n", "G0 X0 Y0\n", "G1 F500 X120. Y-30.\n",
                                        "M30\n", "%"};
    static const char *const second[] = {"\nO12(TEST)\nG1F0.3W10.\nM30\n%"};
    char text[256];
    PRGDIR *directory = (PRGDIR *)text;
    short type;
    say("download", send_pieces(first, 8));
    say(",", send_pieces(second, 1));
    printf("\n");
    receive(12, 10);
    for (type = 0; type <= 2; type++) {
        memset(text, 0, sizeof text);
        say("directory", cnc_rdprogdir(handle, type, 1, 9999, 255, directory));
        printf(": ");
        say_lines(text, 255);
        printf("\n");
    }
    say("search", cnc_search(handle, 12));
    say(", delete", cnc_delete(handle, 12));
    say(", again", cnc_delete(handle, 12));
    say(", without a start", cnc_download(handle, "%", 1));
    say(", start", cnc_dwnstart(handle));
    say(", twice", cnc_dwnstart(handle));
    say(", nothing came", cnc_dwnend(handle));
    printf("\n");
}

static void offsets(void)
{
    IODBTO all;
    ODBTOFS one;
    int k;
    memset(&all, 0, sizeof all);
    all.datano_s = 1;
    all.type = -1;
    all.datano_e = TOOLS;
    for (k = 0; k < TOOLS; k++)
        all.u.m_ofs[k] = 1000 + 7 * k;
    say("offsets", cnc_wrtofsr(handle, 6 + 4 * TOOLS, &all));
    memset(&all, 0, sizeof all);
    say(", read", cnc_rdtofsr(handle, 1, 0, TOOLS, 6 + 4 * TOOLS, &all));
    printf(": %d to %d", (int)all.u.m_ofs[0], (int)all.u.m_ofs[TOOLS - 1]);
    say(", one", cnc_rdtofs(handle, 3, 0, 8, &one));
    printf(": %d\n", (int)one.data);
}

static void parameters(void)
{
    IODBPSD limit, names;
    char codes[6 * 10];
    short k, number, type = 0;
    for (k = 0; k < 10; k++) { /* records of six bytes: number, type, and a value of a byte with one that fills */
        number = (short)(6080 + k);
        memset(codes + 6 * k, 0, 6);
        memcpy(codes + 6 * k, &number, 2);
        memcpy(codes + 6 * k + 2, &type, 2);
        codes[6 * k + 4] = (char)(60 + k);
    }
    say("M codes", cnc_wrparas(handle, sizeof codes, codes));
    say(", the last", cnc_rdparam(handle, 6089, 0, 4 + 1, &limit));
    printf(": %d\n", limit.u.cdata);
    limit.datano = 1320;
    limit.type = 1;
    limit.u.ldata = 400000;
    say("limit", cnc_wrparam(handle, 8, &limit));
    limit.u.ldata = 0;
    say(", read", cnc_rdparam(handle, 1320, 1, 8, &limit));
    printf(": %d\n", (int)limit.u.ldata);
    say("axes", cnc_rdparam(handle, 1020, ALL_AXES, 4 + MAX_AXIS, &names));
    for (k = 0; k < 3; k++)
        printf("%s%c", k ? " " : ": ", names.u.cdatas[k]);
    printf("\n");
}

/* A value with its point, nine digits of which a zero in front is not shown. */
static const char *shown(PC_LONG value, short decimals)
{
    static char text[16];
    char digits[16];
    sprintf(digits, "%09d", (int)value);
    if (digits[0] == '0')
        digits[0] = ' ';
    sprintf(text, "%.*s.%s", 9 - decimals, digits, digits + 9 - decimals);
    return text;
}

static void macros(void)
{
    static const PC_LONG values[3] = {1500, -1500, 25};
    IODBMR range;
    ODBM one;
    short k, decimals = 3;
    say("macro", cnc_wrmacro(handle, 120, 10, 1500, decimals));
    say(", read", cnc_rdmacro(handle, 120, 10, &one));
    printf(" [%s]\n", shown(one.mcr_val, one.dec_val));
    memset(&range, 0, sizeof range);
    range.datano_s = 500;
    range.datano_e = 502;
    for (k = 0; k < 3; k++) {
        range.data[k].mcr_val = values[k];
        range.data[k].dec_val = decimals;
    }
    say("macros", cnc_wrmacror(handle, (short)RANGE(3), &range));
    memset(&range, 0, sizeof range);
    say(", read", cnc_rdmacror(handle, 500, 502, (short)RANGE(3), &range));
    for (k = 0; k < 3; k++)
        printf(" [%s]", shown(range.data[k].mcr_val, range.data[k].dec_val));
    printf("\n");
}

static void pmc(void)
{
    IODBPMC data;
    int k, sum = 0;
    memset(&data, 0, sizeof data);
    data.type_a = 9; /* data table */
    data.type_d = 1; /* words */
    data.datano_s = 100;
    data.datano_e = 101;
    data.u.idata[0] = 250;
    say("D100", pmc_wrpmcrng(handle, 10, &data));
    data.u.idata[0] = 0;
    say(", read", pmc_rdpmcrng(handle, 9, 1, 100, 101, 10, &data));
    printf(": %d, bytes", data.u.idata[0]);
    say("", pmc_rdpmcrng(handle, 9, 0, 100, 101, 10, &data));
    printf(": %d %d\n", data.u.cdata[0] & 0xFF, data.u.cdata[1]);
    memset(&data, 0, sizeof data);
    data.type_a = 5; /* internal relays */
    data.datano_s = 200;
    data.datano_e = 209;
    say("R200", pmc_wrpmcrng(handle, 18, &data));
    memset(data.u.cdata, 1, 10);
    say(", read", pmc_rdpmcrng(handle, 5, 0, 200, 209, 18, &data));
    for (k = 0; k < 10; k++)
        sum += data.u.cdata[k];
    printf(": all bytes together %d\n", sum);
}

static void state(void)
{
    ODBSYS system;
    ODBALM alarms;
    ODBAXIS at;
    IDBWRR preset;
    cnc_sysinfo(handle, &system);
    printf("control %.2s%.2s of %d axes, %.2s of them controlled\n", system.cnc_type, system.mt_type, system.max_axis,
           system.axes);
    cnc_alarm(handle, &alarms);
    printf(alarms.data ? "ALARM\n" : "NO ALARM\n");
    memset(&preset, 0, sizeof preset);
    preset.type = 1;
    preset.data[0] = 120005;
    say("preset", cnc_wrrelpos(handle, 8, &preset));
    say(", read", cnc_relative(handle, 1, 8, &at));
    printf(": %d\n", (int)at.data[0]);
}

int main(void)
{
    IODBSGNL panel;
    short code = cnc_allclibhndl(&handle);
    printf("open %d\n", code);
    if (code)
        return 1;
    state();
    memset(&panel, 0, sizeof panel);
    panel.type = 1; /* the mode alone */
    panel.mode = 3; /* edit */
    say("edit", cnc_wropnlsgnl(handle, &panel));
    printf("\n");
    programs();
    offsets();
    parameters();
    macros();
    pmc();
    say("free", cnc_freelibhndl(handle));
    printf("\n");
    return 0;
}
