/* What all functions share: connections to the machines, and calls over them.

   A call is a frame, its answer another one; both lie in the memory of their connection, never on the program's stack.
   Nothing is written into the program's memory before the whole answer is here and every size in it has been checked. */
#if PC_INTERRUPTS
static int pc_calls_begin(void);
static void pc_calls_end(int counted);
static void pc_listen_again(void);
#ifndef _WIN32
static void pc_line_enter(void);
static void pc_line_leave(void);
static void pc_line_forget(void);
#endif
#else
#define pc_calls_begin() 0
#define pc_calls_end(counted) (void)(counted)
#define pc_listen_again() (void)0
#define pc_line_enter() (void)0
#define pc_line_leave() (void)0
#define pc_line_forget() (void)0
#endif

#define PC_SLICE_MS 50

/* `pc_all` is held for an instant and never while anything is waited for, the lock of a connection while a call is carried
   out on it. `pc_all` may be entered while that one is held, never the other way round. */
typedef struct {
    pc_lock lock;
    int open; /* this and the next four are written with both locks held: either will do to read them */
    pc_socket socket;
    uint32_t tries; /* to connect, that have ended: tells a connection from the one that was here before */
    int wait_ms;
    uint16_t serial;
    int reserved; /* somebody is connecting; from here on `pc_all` is held */
    int code;     /* of the last try */
    int handles;
    char place[280];
} pc_connection;

/* A connection, by its number, as it was when it was found; -1: none. */
typedef struct {
    int number;
    uint32_t tries;
} pc_link;

static pc_lock pc_all = PC_UNLOCKED;
static pc_condition pc_tried = PC_UNCHANGED; /* a try to connect has ended */
static pc_connection pc_connections[PC_CONNECTIONS];
static unsigned char pc_frames[PC_CONNECTIONS][PC_MOST];
static pc_link pc_default = {-1, 0};
static const pc_link pc_no_link = {-1, 0};
#if PC_HANDLES
#define PC_GONE 0xFF /* the number and 1 of a connection that was lost, and whose place another one has taken */
static struct {
    uint8_t connection; /* its number and 1; 0: no handle of this program */
    uint16_t there;
} pc_handles[0x10000];
#endif

#ifdef _WIN32
static void pc_begin(void) /* locks of zeros are free */
{
    static LONG done;
    WSADATA data;
    if (!done) {
        pc_enter(&pc_all);
        if (!done)
            WSAStartup(MAKEWORD(2, 2), &data);
        InterlockedExchange(&done, 1);
        pc_leave(&pc_all);
    }
}
#else
/* A fork waits until no other thread is in `pc_all`; its child has no connection, no handle and no lock of the parent's. */
static void pc_fork_begins(void)
{
    pc_enter(&pc_all);
    pc_line_enter();
}

static void pc_fork_is_done(void)
{
    pc_line_leave();
    pc_leave(&pc_all);
}

static void pc_fork_begets(void)
{
    int k;
#ifdef PC_IN_PROCESS
    pc_is_child = 1;
#endif
    for (k = 0; k < PC_CONNECTIONS; k++)
        if (pc_connections[k].open)
            pc_shut(pc_connections[k].socket);
    memset(pc_connections, 0, sizeof pc_connections);
    for (k = 0; k < PC_CONNECTIONS; k++)
        pthread_mutex_init(&pc_connections[k].lock, NULL);
#if PC_HANDLES
    memset(pc_handles, 0, sizeof pc_handles);
#endif
    pc_default = pc_no_link;
    pthread_cond_init(&pc_tried, NULL);
    pthread_mutex_init(&pc_all, NULL);
    pc_line_forget();
}

static void pc_begin_once(void)
{
    int k;
    for (k = 0; k < PC_CONNECTIONS; k++)
        pthread_mutex_init(&pc_connections[k].lock, NULL);
    pthread_atfork(pc_fork_begins, pc_fork_is_done, pc_fork_begets);
}

static void pc_begin(void)
{
    static pthread_once_t once = PTHREAD_ONCE_INIT;
    pthread_once(&once, pc_begin_once);
}
#endif

/* The path of the program, or of this library; 0 if it is unknown or too long. */
static int pc_path(int of_library, char *path, size_t room)
{
#ifdef _WIN32
    HMODULE module = NULL;
    DWORD size, flags = GET_MODULE_HANDLE_EX_FLAG_FROM_ADDRESS | GET_MODULE_HANDLE_EX_FLAG_UNCHANGED_REFCOUNT;
    if (of_library && !GetModuleHandleExA(flags, (const char *)&pc_all, &module))
        return 0;
    size = GetModuleFileNameA(module, path, (DWORD)room);
    return size > 0 && size < room;
#else
    Dl_info found;
    ssize_t size;
    if (of_library)
        return dladdr(&pc_all, &found) && found.dli_fname && (size_t)snprintf(path, room, "%s", found.dli_fname) < room;
    size = readlink("/proc/self/exe", path, room);
    if (size <= 0 || (size_t)size >= room)
        return 0;
    path[size] = 0;
    return 1;
#endif
}

/* Read the line calls = "host:port" of polycnc.toml beside the program, or beside this library. */
static int pc_read_file(int of_library, char *place, size_t room)
{
    char path[1100], line[400], value[280];
    char *slash;
    FILE *file;
    int found = 0;
    if (!pc_path(of_library, path, 1000))
        return 0;
#ifdef _WIN32
    slash = strrchr(path, '\\');
#else
    slash = strrchr(path, '/');
#endif
    if (!slash)
        return 0;
    strcpy(slash + 1, "polycnc.toml");
    file = fopen(path, "r");
    if (!file)
        return 0;
    while (!found && fgets(line, sizeof line, file))
        if (sscanf(line, " calls = \"%270[^\"]\"", value) == 1) {
            snprintf(place, room, "%s", value);
            found = 1;
        }
    fclose(file);
    return found;
}

static void pc_where(char *place, size_t room)
{
    const char *said = getenv("POLYCNC_CALLS");
    if (said && *said)
        snprintf(place, room, "%s", said);
    else if (!pc_read_file(0, place, room) && !pc_read_file(1, place, room))
        snprintf(place, room, "127.0.0.1:" PC_PORT);
}

/* The number of the connection that is open or being opened to a place, -1 if there is none. `pc_all` is held. */
static int pc_find(const char *place)
{
    int k, found = -1;
    for (k = 0; k < PC_CONNECTIONS; k++) {
        const pc_connection *each = &pc_connections[k];
        if ((each->open || each->reserved) && !strcmp(each->place, place) && (found < 0 || each->open))
            found = k;
    }
    return found;
}

/* Take a place for a connection, at best one that no handle leads to; -1 if all are open. `pc_all` is held. */
static int pc_reserve(const char *place)
{
    int k, found = -1;
    for (k = 0; k < PC_CONNECTIONS; k++) {
        const pc_connection *each = &pc_connections[k];
        if (!each->open && !each->reserved && (found < 0 || each->handles < pc_connections[found].handles))
            found = k;
    }
    if (found < 0)
        return found;
#if PC_HANDLES
    if (pc_connections[found].handles)
        for (k = 0; k < 0x10000; k++)
            if (pc_handles[k].connection == found + 1)
                pc_handles[k].connection = PC_GONE;
#endif
    pc_connections[found].handles = 0;
    pc_connections[found].reserved = 1;
    snprintf(pc_connections[found].place, sizeof pc_connections[found].place, "%s", place);
    return found;
}

/* Tell everybody how a try to connect has ended. */
static pc_link pc_publish(int number, pc_socket socket, int wait_ms, int code)
{
    pc_connection *on = &pc_connections[number];
    pc_link made;
    pc_enter(&on->lock);
    pc_enter(&pc_all);
    on->open = !code;
    on->socket = socket;
    on->wait_ms = wait_ms;
    on->serial = 0;
    on->code = code;
    on->reserved = 0;
    made.number = code ? -1 : number;
    made.tries = ++on->tries;
    pc_wake(&pc_tried);
    pc_leave(&pc_all);
    pc_leave(&on->lock);
    return made;
}

/* Give a connection up, and its socket to the caller. The lock of the connection is held. */
static pc_socket pc_lose(pc_connection *on)
{
    pc_enter(&pc_all);
    on->open = 0;
    pc_leave(&pc_all);
    return on->socket;
}

/* Connect, while `pc_all` is free for the calls of other threads. */
static pc_link pc_try(int number, const char *place, int wait_ms, int nobody, int *code)
{
    pc_socket made = pc_connect(place, wait_ms, nobody, code);
    return pc_publish(number, made, wait_ms, *code);
}

/* A connection to a place, the one that there is or a new one; *code says why there is none. Of a thread that is connecting
   to this place, the outcome is waited for. */
static pc_link pc_open(const char *place, int wait_ms, int nobody, int *code)
{
    pc_link made = pc_no_link;
    int k, left_ms = wait_ms;
    *code = nobody;
    pc_enter(&pc_all);
    while ((k = pc_find(place)) >= 0 && pc_connections[k].reserved) {
        const pc_connection *on = &pc_connections[k];
        uint32_t before = on->tries;
        while (on->reserved && on->tries == before && left_ms)
            if (!pc_wait(&pc_tried, &pc_all, PC_SLICE_MS) && left_ms > 0)
                left_ms = left_ms > PC_SLICE_MS ? left_ms - PC_SLICE_MS : 0;
        if (!left_ms || (on->tries == before + 1 && on->code)) {
            if (left_ms)
                *code = on->code;
            pc_leave(&pc_all);
            return made;
        }
    }
    if (k >= 0) {
        made.number = k;
        made.tries = pc_connections[k].tries;
        *code = 0;
    } else if ((k = pc_reserve(place)) >= 0) {
        pc_leave(&pc_all);
        return pc_try(k, place, wait_ms, nobody, code);
    }
    pc_leave(&pc_all);
    return made;
}

/* The connection of calls without a handle; a lost one comes back with a call that opens. */
static pc_link pc_usual(int opens, int *code)
{
    char place[280];
    pc_link made;
    int is_there;
    pc_enter(&pc_all);
    made = pc_default;
    is_there = made.number >= 0 && pc_connections[made.number].open && pc_connections[made.number].tries == made.tries;
    pc_leave(&pc_all);
    if (is_there)
        return made;
    if (made.number >= 0 && !opens) {
        *code = PC_CODE_LOST;
        return pc_no_link;
    }
    pc_where(place, sizeof place);
    made = pc_open(place, PC_WAIT_MS, opens ? PC_CODE_NOBODY : PC_CODE_LOST, code);
    if (made.number >= 0) {
        pc_enter(&pc_all);
        pc_default = made;
        pc_leave(&pc_all);
    }
    return made;
}

/* Tell whether a connection is there still; one that the other side has ended is shut. */
static int pc_is_live(pc_link link)
{
    pc_connection *on = &pc_connections[link.number];
    int live;
    pc_enter(&on->lock);
    live = on->open && on->tries == link.tries;
    if (live && pc_ended(on->socket)) {
        pc_shut(pc_lose(on));
        live = 0;
    }
    pc_leave(&on->lock);
    return live;
}

/* The connection of a call that opens, the usual one without a place: a new one if that of before has been ended. */
static pc_link pc_opened(const char *place, int wait_ms, int *code)
{
    pc_link made;
    int tries;
    for (tries = 0; tries < 2; tries++) {
        made = place ? pc_open(place, wait_ms, PC_CODE_LOST, code) : pc_usual(1, code);
        if (made.number < 0 || pc_is_live(made))
            break;
    }
    return made;
}

static uint32_t pc_put(unsigned char *frame, uint32_t at, const void *from, uint32_t size)
{
    if (at && at <= PC_MOST && size <= PC_MOST - at) {
        if (size)
            memcpy(frame + at, from, size);
        return at + size;
    }
    return 0;
}

/* Write a call into a frame; its size, 0 if it does not fit. */
static uint32_t pc_pack(unsigned char *frame, uint16_t number, uint16_t serial, const pc_argument *given, int count)
{
    uint32_t at = 8, size;
    int k;
    memcpy(frame + 4, &number, 2);
    memcpy(frame + 6, &serial, 2);
    for (k = 0; k < count; k++) {
        const pc_argument *each = &given[k];
        if (each->what == PC_VALUE) {
            at = pc_put(frame, at, each->from, each->size);
            continue;
        }
        if (each->what != PC_WRITE) {
            size = each->from ? each->size : PC_NULL;
            at = pc_put(frame, at, &size, 4);
            if (each->from)
                at = pc_put(frame, at, each->from, size);
        }
        if (each->what != PC_READ) {
            size = !each->to ? PC_NULL : each->room > PC_MOST_ROOM ? PC_MOST_ROOM : each->room;
            at = pc_put(frame, at, &size, 4);
        }
    }
    size = at - 4;
    memcpy(frame, &size, 4);
    return at;
}

/* Write an answer where the program wants it, if all of it is as it must be. */
static int pc_unpack(const unsigned char *frame, uint32_t size, const pc_argument *given, int count)
{
    uint32_t at = PC_HEAD, sizes = 0, sum = 0, one, from;
    int k;
    for (k = 0; k < count; k++)
        if (given[k].what >= PC_WRITE)
            sizes += 4;
    if (size < PC_HEAD + sizes)
        return 0;
    for (k = 0; k < count; k++) {
        if (given[k].what < PC_WRITE)
            continue;
        memcpy(&one, frame + at, 4);
        at += 4;
        if (one > (given[k].to ? given[k].room : 0) || one > PC_MOST)
            return 0;
        sum += one;
    }
    if (sum != size - at)
        return 0;
    from = at;
    at = PC_HEAD;
    for (k = 0; k < count; k++) {
        if (given[k].what < PC_WRITE)
            continue;
        memcpy(&one, frame + at, 4);
        at += 4;
        if (one)
            memcpy(given[k].to, frame + from, one);
        from += one;
    }
    return 1;
}

/* Carry out a call on a connection; 0, or the code why it was not. */
static int pc_exchange(pc_link link, uint16_t number, const pc_argument *given, int count, pc_result *result)
{
    pc_connection *on = &pc_connections[link.number];
    unsigned char *frame = pc_frames[link.number];
    uint32_t size;
    uint16_t heard[2];
    int code = PC_CODE_LOST;
    pc_enter(&on->lock);
    if (on->open && on->tries == link.tries) {
        uint16_t serial = ++on->serial;
        size = pc_pack(frame, number, serial, given, count);
        if (!size) {
            pc_leave(&on->lock);
            return PC_CODE_NULL;
        }
        if ((size = pc_round(on->socket, frame, size, on->wait_ms)) != 0) {
            memcpy(heard, frame + 4, 4);
            if (heard[0] == number && heard[1] == serial && pc_unpack(frame, size, given, count)) {
                memcpy(&result->whole, frame + 12, 8);
                memcpy(&result->real, frame + 12, 8);
                code = 0;
            }
        }
        if (code)
            pc_shut(pc_lose(on));
    }
    pc_leave(&on->lock);
    return code;
}

static pc_result pc_coded(int code)
{
    pc_result made;
    made.whole = code;
    made.real = 0;
    made.failed = 1;
    return made;
}

#if PC_HANDLES
/* Give a handle of the other side a number of this program: its own if that is free. `pc_all` is held. */
static uint16_t pc_name(int connection, uint16_t there)
{
    uint32_t tried, here = there;
    for (tried = 0; tried < 0xFFFF; tried++) {
        if (here && !pc_handles[here].connection) {
            pc_handles[here].connection = (uint8_t)(connection + 1);
            pc_handles[here].there = there;
            pc_connections[connection].handles++;
            return (uint16_t)here;
        }
        here = here % 0xFFFF + 1;
    }
    return 0;
}

static void pc_forget(uint16_t handle)
{
    pc_enter(&pc_all);
    if (pc_handles[handle].connection && pc_handles[handle].connection != PC_GONE)
        pc_connections[pc_handles[handle].connection - 1].handles--;
    pc_handles[handle].connection = 0;
    pc_leave(&pc_all);
}

/* Carry out a call that reaches its machine through a handle, its first argument. */
static pc_result pc_through(uint16_t number, int way, pc_argument *given, int count)
{
    uint16_t handle, there;
    pc_result result = {0, 0, 0};
    pc_link link = {-1, 0};
    int connection, code = PC_CODE_LOST;
    memcpy(&handle, given[0].from, 2);
    pc_enter(&pc_all);
    connection = pc_handles[handle].connection;
    there = pc_handles[handle].there;
    if (connection && connection != PC_GONE) {
        link.number = connection - 1;
        link.tries = pc_connections[link.number].tries;
    }
    pc_leave(&pc_all);
    if (!connection)
        return pc_coded(PC_CODE_HANDLE);
    given[0].from = &there;
    if (link.number >= 0)
        code = pc_exchange(link, number, given, count, &result);
    if (way == PC_FREES && (code || !result.whole)) {
        pc_forget(handle);
        return pc_coded(0); /* what was lost is let go too */
    }
    return code ? pc_coded(code) : result;
}

/* Carry out a call that makes a handle, its last argument; at an address, its first ones say which and how long. */
static pc_result pc_opening(uint16_t number, int way, pc_argument *given, int count)
{
    pc_argument *last = &given[count - 1];
    uint16_t *to = (uint16_t *)last->to, there = 0, here;
    pc_result result = {0, 0, 0};
    pc_link link = {-1, 0};
    int code = 0, is_here;
    if (!to)
        return pc_coded(PC_CODE_NULL);
    last->to = &there;
    if (way == PC_OPENS_AT) {
        char place[280];
        uint16_t port;
        int32_t wait_s;
        memcpy(&port, given[1].from, 2);
        memcpy(&wait_s, given[2].from, 4);
        code = given[0].from ? PC_CODE_LOST : PC_CODE_NULL;
        if (given[0].from && wait_s >= 0 && port && given[0].size <= 256) {
            const char *name = (const char *)given[0].from;
            snprintf(place, sizeof place, strchr(name, ':') ? "[%s]:%u" : "%s:%u", name, (unsigned)port);
            link = pc_opened(place, wait_s ? wait_s > 600 ? 600000 : wait_s * 1000 : -1, &code);
        }
    } else
        link = pc_opened(NULL, 0, &code);
    if (link.number < 0)
        return pc_coded(code);
    code = pc_exchange(link, number, given, count, &result);
    if (code || result.whole)
        return code ? pc_coded(code) : result;
    pc_enter(&pc_all);
    is_here = pc_connections[link.number].tries == link.tries;
    here = is_here ? pc_name(link.number, there) : 0;
    pc_leave(&pc_all);
    if (!here)
        return pc_coded(is_here ? PC_CODE_HANDLE : PC_CODE_LOST);
    memcpy(to, &here, sizeof here);
    return result;
}
#endif

static pc_result pc_call(uint16_t number, int way, pc_argument *given, int count)
{
    pc_result result = {0, 0, 0};
    pc_link link;
    int code = 0;
    pc_begin();
#if PC_HANDLES
    if (way == PC_THROUGH || way == PC_FREES)
        return pc_through(number, way, given, count);
    if (way == PC_OPENS || way == PC_OPENS_AT)
        return pc_opening(number, way, given, count);
#endif
    link = way == PC_OPENS ? pc_opened(NULL, 0, &code) : pc_usual(0, &code);
    if (link.number >= 0) {
        int counted = pc_calls_begin();
        code = pc_exchange(link, number, given, count, &result);
        pc_calls_end(counted);
        if (way == PC_OPENS && !code && !result.whole)
            pc_listen_again();
    }
    return code ? pc_coded(code) : result;
}
