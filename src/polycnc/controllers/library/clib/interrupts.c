
/* The program's routine for interrupts. A thread waits on a connection of its own and calls it, never while a call of
   the program is being carried out; calls that come meanwhile wait for its end, for a second at most, since it may wait
   for the program in turn. What the routine itself calls does not wait. */
#ifdef _WIN32
typedef DWORD pc_thread;
#define pc_me() GetCurrentThreadId()
#define pc_same(one, other) ((one) == (other))
#else
#include <signal.h>
typedef pthread_t pc_thread;
#define pc_me() pthread_self()
#define pc_same(one, other) pthread_equal(one, other)
#endif

#define PC_ROUTINE_MS 1000

static struct {
    pc_lock lock;
    pc_condition changed;
    int calls;   /* of the program, that are being carried out */
    int running; /* the routine runs, or is next */
    pc_thread runner;
    int serial; /* of the thread whose interrupts count */
    InterruptRoutine routine;
    pc_socket socket;
    uint16_t number;
    int32_t what; /* the board, from 1 */
} pc_line = {.lock = PC_UNLOCKED, .changed = PC_UNCHANGED, .socket = PC_NO_SOCKET};

/* Wait until the routine does not run, for a time. The lock of the line is held. */
static void pc_await_routine(void)
{
    int left = PC_ROUTINE_MS / 10;
    while (pc_line.running && left-- > 0)
        pc_wait(&pc_line.changed, &pc_line.lock, 10);
}

static int pc_calls_begin(void)
{
    int counted;
    pc_enter(&pc_line.lock);
    counted = !(pc_line.running && pc_same(pc_line.runner, pc_me()));
    if (counted) {
        pc_await_routine();
        pc_line.calls++;
    }
    pc_leave(&pc_line.lock);
    return counted;
}

static void pc_calls_end(int counted)
{
    if (!counted)
        return;
    pc_enter(&pc_line.lock);
    if (!--pc_line.calls)
        pc_wake(&pc_line.changed);
    pc_leave(&pc_line.lock);
}

#ifndef _WIN32
static void pc_line_enter(void)
{
    pc_enter(&pc_line.lock);
}

static void pc_line_leave(void)
{
    pc_leave(&pc_line.lock);
}

/* Have no routine and no thread, in a child of the process that had them. */
static void pc_line_forget(void)
{
    pthread_mutex_init(&pc_line.lock, NULL);
    pthread_cond_init(&pc_line.changed, NULL);
    if (pc_line.socket != PC_NO_SOCKET)
        pc_shut(pc_line.socket);
    pc_line.calls = pc_line.running = 0;
    pc_line.serial++;
    pc_line.routine = NULL;
    pc_line.socket = PC_NO_SOCKET;
}
#endif

/* Call the routine once, if it is still the one of this thread. */
static int pc_call_routine(int serial, int32_t lines)
{
    InterruptRoutine routine = NULL;
    pc_enter(&pc_line.lock);
    while (pc_line.running && pc_line.serial == serial)
        pc_wait(&pc_line.changed, &pc_line.lock, 100);
    if (pc_line.serial == serial) {
        pc_line.running = 1;
        pc_line.runner = pc_me();
        while (pc_line.calls && pc_line.serial == serial)
            pc_wait(&pc_line.changed, &pc_line.lock, 100);
        routine = pc_line.serial == serial ? pc_line.routine : NULL;
        if (routine) {
            pc_leave(&pc_line.lock);
            routine((int)lines);
            pc_enter(&pc_line.lock);
        }
        pc_line.running = 0;
        pc_wake(&pc_line.changed);
    }
    pc_leave(&pc_line.lock);
    return routine != NULL;
}

static void pc_attend(int serial)
{
    unsigned char frame[12];
    int32_t lines;
    pc_socket socket;
    pc_enter(&pc_line.lock);
    socket = pc_line.serial == serial ? pc_line.socket : PC_NO_SOCKET;
    pc_leave(&pc_line.lock);
    if (socket == PC_NO_SOCKET)
        return;
    do {
        if (!pc_receive(socket, frame, sizeof frame, -1))
            break;
        memcpy(&lines, frame + 8, 4);
    } while (pc_call_routine(serial, lines));
    pc_enter(&pc_line.lock);
    if (pc_line.serial == serial)
        pc_line.socket = PC_NO_SOCKET;
    pc_leave(&pc_line.lock);
    pc_shut(socket);
}

#ifdef _WIN32
static DWORD WINAPI pc_thread_main(void *given)
{
    pc_attend((int)(intptr_t)given);
    return 0;
}

static int pc_start(int serial)
{
    HMODULE module; /* stays in the program as long as it may have this thread */
    HANDLE made;
    GetModuleHandleExA(GET_MODULE_HANDLE_EX_FLAG_FROM_ADDRESS | GET_MODULE_HANDLE_EX_FLAG_PIN,
                       (const char *)(void *)&pc_line, &module);
    made = CreateThread(NULL, 0, pc_thread_main, (void *)(intptr_t)serial, 0, NULL);
    if (made)
        CloseHandle(made);
    return made != NULL;
}
#else
static void *pc_thread_main(void *given)
{
    pc_attend((int)(intptr_t)given);
    return NULL;
}

static int pc_start(int serial)
{
    sigset_t all, before;
    pthread_attr_t detached;
    pthread_t made;
    int failed;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before); /* signals are the program's */
    pthread_attr_init(&detached);
    pthread_attr_setdetachstate(&detached, PTHREAD_CREATE_DETACHED);
    failed = pthread_create(&made, &detached, pc_thread_main, (void *)(intptr_t)serial);
    pthread_attr_destroy(&detached);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    return !failed;
}
#endif

/* Let no thread call a routine any more; whoever is in one has returned, unless that takes a second. */
static void pc_stop_routine(void)
{
    pc_enter(&pc_line.lock);
    pc_line.serial++;
    pc_line.routine = NULL;
    if (pc_line.socket != PC_NO_SOCKET)
        shutdown(pc_line.socket, 2); /* its thread closes it */
    pc_line.socket = PC_NO_SOCKET;
    pc_wake(&pc_line.changed);
    if (!(pc_line.running && pc_same(pc_line.runner, pc_me())))
        pc_await_routine();
    pc_leave(&pc_line.lock);
}

/* Have a connection, which nobody else finds, carry out a call; it goes to whoever called this. */
static pc_socket pc_own_socket(uint16_t number, const pc_argument *given, int *code)
{
    char place[280] = "";
    pc_result result = {0, 0, 0};
    pc_socket made = PC_NO_SOCKET;
    pc_link link;
    int own;
    pc_enter(&pc_all);
    if (pc_default.number >= 0)
        snprintf(place, sizeof place, "%s", pc_connections[pc_default.number].place);
    own = pc_reserve("");
    pc_leave(&pc_all);
    *code = PC_CODE_LOST;
    if (own < 0)
        return made;
    link = pc_try(own, place, PC_WAIT_MS, PC_CODE_LOST, code);
    if (!*code)
        *code = pc_exchange(link, number, given, 1, &result);
    if (*code)
        return made;
    pc_enter(&pc_connections[own].lock);
    made = pc_lose(&pc_connections[own]);
    pc_leave(&pc_connections[own].lock);
    if (result.whole) {
        pc_shut(made);
        *code = (int)result.whole;
        return PC_NO_SOCKET;
    }
    pc_limit(made, -1);
    return made;
}

/* Have a connection of its own for the interrupts of a board, and a thread that waits for them; 0, or why not. */
static int pc_listen(InterruptRoutine routine, uint16_t number, int32_t what)
{
    pc_argument given[1];
    pc_socket own;
    int code, serial, started = 1;
    given[0].what = PC_VALUE;
    given[0].from = &what;
    given[0].size = sizeof what;
    given[0].to = NULL;
    given[0].room = 0;
    own = pc_own_socket(number, given, &code);
    if (code)
        return code;
    pc_enter(&pc_line.lock);
    serial = ++pc_line.serial;
    pc_line.socket = own;
    pc_line.number = number;
    pc_line.what = what;
    pc_line.routine = routine;
    pc_leave(&pc_line.lock);
    if (!pc_start(serial)) {
        pc_enter(&pc_line.lock);
        if ((started = pc_line.serial != serial) == 0) {
            pc_line.routine = NULL;
            pc_line.socket = PC_NO_SOCKET;
        }
        pc_leave(&pc_line.lock);
        pc_shut(own);
    }
    return started ? 0 : PC_CODE_LOST;
}

/* Listen again with the routine that was there when the other side was lost. */
static void pc_listen_again(void)
{
    InterruptRoutine routine;
    pc_enter(&pc_line.lock);
    routine = pc_line.socket == PC_NO_SOCKET ? pc_line.routine : NULL;
    pc_leave(&pc_line.lock);
    if (routine)
        pc_listen(routine, pc_line.number, pc_line.what);
}

static int pc_set_routine(uint16_t number, InterruptRoutine routine)
{
    int32_t what = 0; /* asks which board is selected */
    pc_argument given[1];
    pc_result result;
    if (!routine)
        return PC_CODE_NULL;
    given[0].what = PC_VALUE;
    given[0].from = &what;
    given[0].size = sizeof what;
    given[0].to = NULL;
    given[0].room = 0;
    result = pc_call(number, PC_PLAIN, given, 1);
    if (result.failed)
        return (int)result.whole;
    if (result.whole < 0)
        return PC_CODE_NULL;
    pc_stop_routine();
    return pc_listen(routine, number, (int32_t)result.whole + 1);
}

static int pc_reset_routine(uint16_t number)
{
    pc_result result = pc_call(number, PC_PLAIN, 0, 0);
    pc_stop_routine();
    return (int)result.whole;
}

