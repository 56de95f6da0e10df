/* What all functions below share: connections to the served machines, and calls over them. Sockets, nothing else.

   A call is a frame, its answer another one; both lie on the stack. Nothing is written into the program's memory before
   the whole answer is here and every size in it has been checked. With PC_IN_PROCESS the machines are in this process,
   in an interpreter of Python, and the same frames go to it. */
#ifdef _WIN32
#define _WIN32_WINNT 0x0600
#include <winsock2.h>
#include <ws2tcpip.h>
#else
#define _POSIX_C_SOURCE 200809L
#define _DEFAULT_SOURCE 1
#define _DARWIN_C_SOURCE 1
#ifdef PC_IN_PROCESS
#define PY_SSIZE_T_CLEAN
#include <Python.h>
#endif
#include <errno.h>
#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <pthread.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/types.h>
#include <unistd.h>
#endif
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
#error "the structures of this library are those of little-endian machines"
#endif

#define PC_MOST 65536u     /* bytes of a frame */
#define PC_NULL 0xFFFFFFFFu /* the size of what a null pointer leads to */
#define PC_WAIT_MS 10000   /* for an answer, where the program says nothing */
#define PC_CONNECTIONS 64
#define PC_HEAD 20u /* length, number, serial, state, result */

#if defined(__GNUC__)
#define PC_UNUSED __attribute__((unused))
#else
#define PC_UNUSED
#endif

#ifdef _WIN32
typedef SOCKET pc_socket;
typedef SRWLOCK pc_lock;
#define PC_NO_SOCKET INVALID_SOCKET
#define PC_UNLOCKED SRWLOCK_INIT
#define pc_enter(lock) AcquireSRWLockExclusive(lock)
#define pc_leave(lock) ReleaseSRWLockExclusive(lock)
#define pc_shut(socket) closesocket(socket)
#define PC_SEND_FLAGS 0
#else
typedef int pc_socket;
typedef pthread_mutex_t pc_lock;
#define PC_NO_SOCKET (-1)
#define PC_UNLOCKED PTHREAD_MUTEX_INITIALIZER
#define pc_enter(lock) pthread_mutex_lock(lock)
#define pc_leave(lock) pthread_mutex_unlock(lock)
#ifdef PC_IN_PROCESS
static void pc_shut(pc_socket client);
#else
#define pc_shut(socket) close(socket)
#endif
#ifdef MSG_NOSIGNAL
#define PC_SEND_FLAGS MSG_NOSIGNAL
#else
#define PC_SEND_FLAGS 0
#endif
#endif

#if PC_INTERRUPTS
static int pc_calls_begin(void);
static void pc_calls_end(int counted);
static void pc_listen_again(void);
#ifndef _WIN32
static void pc_calls_forget(void);
#endif
#else
#define pc_calls_begin() 0
#define pc_calls_end(counted) (void)(counted)
#define pc_listen_again() (void)0
#define pc_calls_forget() (void)0
#endif

enum { PC_VALUE, PC_READ, PC_WRITE, PC_BOTH };
enum { PC_PLAIN, PC_THROUGH, PC_OPENS, PC_OPENS_AT, PC_FREES };
enum { PC_FREE, PC_OPEN, PC_LOST };

typedef struct {
    int what;
    const void *from; /* what is read */
    uint32_t size;
    void *to; /* what is written, and how much may be */
    uint32_t room;
} pc_argument;

typedef struct {
    int64_t whole;
    double real;
    int failed;
} pc_result;

typedef struct {
    pc_lock lock;
    int state;
    pc_socket socket;
    uint16_t serial;
    int handles;
    char place[280];
} pc_connection;

static pc_lock pc_all = PC_UNLOCKED;
static pc_connection pc_connections[PC_CONNECTIONS];
static int pc_ready, pc_default = -1;
#ifndef _WIN32
static pid_t pc_process;
#endif
#if PC_HANDLES
static struct {
    uint8_t connection; /* its number and 1; 0: no handle of this program */
    uint16_t there;
} pc_handles[0x10000];
#endif

/* How much of `size` bytes can be asked for: none of a negative number, never more than a frame holds. */
PC_UNUSED static uint32_t pc_size(int64_t size)
{
    return size < 0 ? 0 : size > (int64_t)PC_MOST ? PC_MOST : (uint32_t)size;
}

PC_UNUSED static uint32_t pc_least(int64_t size, uint32_t other)
{
    return pc_size(size) < other ? pc_size(size) : other;
}

/* A text with its zero; a longer one is cut by the other side. */
PC_UNUSED static uint32_t pc_text(const char *text)
{
    uint32_t size = 0;
    while (text && size < 4096 && text[size])
        size++;
    return text ? size + (size < 4096) : 0;
}

static void pc_begin(void)
{
    int k;
#ifdef _WIN32
    WSADATA data;
    if (pc_ready)
        return;
    WSAStartup(MAKEWORD(2, 2), &data);
    for (k = 0; k < PC_CONNECTIONS; k++)
        InitializeSRWLock(&pc_connections[k].lock);
#else
    if (pc_ready && pc_process == getpid())
        return;
    if (pc_ready) { /* a child: the connections are its parent's */
        for (k = 0; k < PC_CONNECTIONS; k++)
            if (pc_connections[k].state == PC_OPEN)
                pc_shut(pc_connections[k].socket);
        pc_calls_forget();
    }
    memset(pc_connections, 0, sizeof pc_connections);
    for (k = 0; k < PC_CONNECTIONS; k++)
        pthread_mutex_init(&pc_connections[k].lock, NULL);
#if PC_HANDLES
    memset(pc_handles, 0, sizeof pc_handles);
#endif
    pc_default = -1;
    pc_process = getpid();
#endif
    pc_ready = 1;
}

#ifdef PC_IN_PROCESS
static PyObject *pc_inside; /* what answers, once there is an interpreter */

/* Have an interpreter, that of the program if it has one, and the machines in it; 0 if that fails. `pc_all` is held. */
static int pc_python(void)
{
    PyGILState_STATE state;
    PyObject *module;
    if (pc_inside)
        return 1;
    if (!Py_IsInitialized()) {
        const char *said = getenv("POLYCNC_PYTHON");
        PyConfig config;
        PyStatus status;
        PyConfig_InitPythonConfig(&config);
        config.install_signal_handlers = 0;
        config.parse_argv = 0;
        status = PyConfig_SetBytesString(&config, &config.program_name, said && *said ? said : PC_PYTHON);
        if (!PyStatus_Exception(status))
            status = Py_InitializeFromConfig(&config);
        PyConfig_Clear(&config);
        if (PyStatus_Exception(status))
            return 0;
        PyEval_SaveThread();
    }
    state = PyGILState_Ensure();
    module = PyImport_ImportModule("polycnc.servers.inside");
    pc_inside = module ? PyObject_CallMethod(module, "inside", "s", PC_NAME) : NULL;
    Py_XDECREF(module);
    PyErr_Clear();
    PyGILState_Release(state);
    return pc_inside != NULL;
}

/* Let a client send bytes; how many came back, 0 if it has been ended or more than `most` came. */
static uint32_t pc_exchanged(pc_socket client, const unsigned char *sent, uint32_t size, unsigned char *to, uint32_t most)
{
    PyGILState_STATE state = PyGILState_Ensure();
    PyObject *got = PyObject_CallMethod(pc_inside, "receive", "iy#", client, (const char *)sent, (Py_ssize_t)size);
    char *bytes = NULL;
    Py_ssize_t length = 0;
    if (!got || PyBytes_AsStringAndSize(got, &bytes, &length) || length > (Py_ssize_t)most)
        length = 0;
    if (length)
        memcpy(to, bytes, (size_t)length);
    Py_XDECREF(got);
    PyErr_Clear();
    PyGILState_Release(state);
    return (uint32_t)length;
}

static void pc_shut(pc_socket client)
{
    PyGILState_STATE state = PyGILState_Ensure();
    Py_XDECREF(PyObject_CallMethod(pc_inside, "shut", "i", client));
    PyErr_Clear();
    PyGILState_Release(state);
}

static int pc_talk(pc_socket client, const unsigned char *sent, uint32_t size, unsigned char *answer, uint32_t expected)
{
    return pc_exchanged(client, sent, size, answer, expected) == expected;
}

static int pc_ended(pc_socket client)
{
    (void)client; /* the machines end with the program */
    return 0;
}

static uint32_t pc_round(pc_socket client, unsigned char *frame, uint32_t size)
{
    uint32_t have = pc_exchanged(client, frame, size, frame, PC_MOST), said = 0;
    if (have >= PC_HEAD)
        memcpy(&said, frame, 4);
    return have >= PC_HEAD && said == have - 4 ? have : 0;
}

#else
static int pc_send(pc_socket socket, const unsigned char *bytes, uint32_t size)
{
    while (size) {
        int sent = (int)send(socket, (const char *)bytes, (int)size, PC_SEND_FLAGS);
#ifndef _WIN32
        if (sent < 0 && errno == EINTR)
            continue;
#endif
        if (sent <= 0)
            return 0;
        bytes += sent;
        size -= (uint32_t)sent;
    }
    return 1;
}

/* Receive some bytes, at most so many; 0 if nothing more comes. */
static uint32_t pc_some(pc_socket socket, unsigned char *bytes, uint32_t most)
{
    int got;
#ifdef _WIN32
    got = (int)recv(socket, (char *)bytes, (int)most, 0);
#else
    do
        got = (int)recv(socket, (char *)bytes, most, 0);
    while (got < 0 && errno == EINTR);
#endif
    return got > 0 ? (uint32_t)got : 0;
}

static int pc_receive(pc_socket socket, unsigned char *bytes, uint32_t size)
{
    uint32_t got;
    for (; size; bytes += got, size -= got)
        if (!(got = pc_some(socket, bytes, size)))
            return 0;
    return 1;
}

/* Receive an answer, mostly in one go, since nothing follows it; its size, 0 if it is none. */
static uint32_t pc_answer(pc_socket socket, unsigned char *frame)
{
    uint32_t have = 0, size = PC_HEAD, got;
    while (have < size) {
        if (!(got = pc_some(socket, frame + have, PC_MOST - have)))
            return 0;
        have += got;
        if (have >= 4) {
            memcpy(&size, frame, 4);
            if (size < PC_HEAD - 4 || size > PC_MOST - 4)
                return 0;
            size += 4;
        }
    }
    return have == size ? size : 0;
}

/* Tell, without waiting, whether the other side has ended a connection; between calls it says nothing else. */
static int pc_ended(pc_socket socket)
{
#ifdef _WIN32
    fd_set read;
    struct timeval now = {0, 0};
    FD_ZERO(&read);
    FD_SET(socket, &read);
    return select(0, &read, NULL, NULL, &now) != 0;
#else
    struct pollfd asked;
    asked.fd = socket;
    asked.events = POLLIN;
    asked.revents = 0;
    return poll(&asked, 1, 0) > 0;
#endif
}

/* Send bytes and receive so many; 0 if nothing more comes. */
static int pc_talk(pc_socket socket, const unsigned char *sent, uint32_t size, unsigned char *answer, uint32_t expected)
{
    return pc_send(socket, sent, size) && pc_receive(socket, answer, expected);
}

/* Send a frame and receive its answer into its place; its size, 0 if it is none. */
static uint32_t pc_round(pc_socket socket, unsigned char *frame, uint32_t size)
{
    return pc_send(socket, frame, size) ? pc_answer(socket, frame) : 0;
}

/* Connect within a time, and let no later wait take longer; -1: for ever. */
static pc_socket pc_reach(const struct addrinfo *there, int wait_ms)
{
    pc_socket made = socket(there->ai_family, there->ai_socktype, there->ai_protocol);
    int done, error = 0, yes = 1;
    socklen_t size = sizeof error;
    if (made == PC_NO_SOCKET)
        return made;
#ifdef _WIN32
    {
        u_long on = 1, off = 0;
        DWORD limit = wait_ms < 0 ? 0 : (DWORD)wait_ms;
        fd_set written, failed;
        struct timeval wait;
        wait.tv_sec = wait_ms / 1000;
        wait.tv_usec = wait_ms % 1000 * 1000;
        ioctlsocket(made, FIONBIO, &on);
        done = connect(made, there->ai_addr, (int)there->ai_addrlen) == 0;
        if (!done && WSAGetLastError() == WSAEWOULDBLOCK) {
            FD_ZERO(&written);
            FD_ZERO(&failed);
            FD_SET(made, &written);
            FD_SET(made, &failed);
            done = select(0, NULL, &written, &failed, wait_ms < 0 ? NULL : &wait) == 1 && FD_ISSET(made, &written);
        }
        ioctlsocket(made, FIONBIO, &off);
        setsockopt(made, SOL_SOCKET, SO_RCVTIMEO, (const char *)&limit, sizeof limit);
        setsockopt(made, SOL_SOCKET, SO_SNDTIMEO, (const char *)&limit, sizeof limit);
    }
#else
    {
        int flags = fcntl(made, F_GETFL, 0);
        struct pollfd asked;
        struct timeval limit;
        limit.tv_sec = wait_ms < 0 ? 0 : wait_ms / 1000;
        limit.tv_usec = wait_ms < 0 ? 0 : wait_ms % 1000 * 1000;
        asked.fd = made;
        asked.events = POLLOUT;
        asked.revents = 0;
        fcntl(made, F_SETFD, FD_CLOEXEC);
        fcntl(made, F_SETFL, flags | O_NONBLOCK);
        done = connect(made, there->ai_addr, there->ai_addrlen) == 0;
        if (!done && (errno == EINPROGRESS || errno == EINTR)) {
            int found;
            do
                found = poll(&asked, 1, wait_ms);
            while (found < 0 && errno == EINTR);
            done = found == 1;
        }
        fcntl(made, F_SETFL, flags);
        setsockopt(made, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
        setsockopt(made, SOL_SOCKET, SO_SNDTIMEO, &limit, sizeof limit);
#ifdef SO_NOSIGPIPE
        setsockopt(made, SOL_SOCKET, SO_NOSIGPIPE, &yes, sizeof yes);
#endif
    }
#endif
    if (done && getsockopt(made, SOL_SOCKET, SO_ERROR, (void *)&error, &size) == 0 && !error) {
        setsockopt(made, IPPROTO_TCP, TCP_NODELAY, (const void *)&yes, sizeof yes);
        return made;
    }
    pc_shut(made);
    return PC_NO_SOCKET;
}

#endif

/* Say who calls; 0, or the code that the other side refuses it with, or `nobody` if there is none. */
static int pc_greet(pc_socket socket, int nobody)
{
    unsigned char hello[PC_HELLO_SIZE], answer[12];
    int32_t code;
    memset(hello, 0, sizeof hello);
    memcpy(hello, "PNCCALL1", 8);
    hello[8] = (unsigned char)sizeof(void *);
    hello[9] = PC_PACKING;
    memcpy(hello + 12, PC_NAME, sizeof PC_NAME - 1);
    memcpy(hello + 28, PC_VERSION, sizeof PC_VERSION - 1);
    memcpy(hello + 44, pc_table, sizeof pc_table);
    if (!pc_talk(socket, hello, sizeof hello, answer, sizeof answer))
        return nobody;
    if (memcmp(answer, "PNCCALL1", 8))
        return nobody;
    memcpy(&code, answer + 8, 4);
    return (int)code;
}

#ifndef PC_IN_PROCESS
/* Split host:port, [host]:port or host; 0 if it is too long. */
static int pc_split(const char *place, char *host, size_t room, char *port, size_t port_room)
{
    const char *colon = strrchr(place, ':'), *begin = place, *end = colon ? colon : place + strlen(place);
    if (*begin == '[' && end > begin + 1 && end[-1] == ']') {
        begin++;
        end--;
    }
    if ((size_t)(end - begin) >= room || end == begin)
        return 0;
    memcpy(host, begin, (size_t)(end - begin));
    host[end - begin] = 0;
    snprintf(port, port_room, "%s", colon && colon[1] ? colon + 1 : PC_PORT);
    return 1;
}

#endif

/* Read the line calls = "host:port" of polycnc.toml beside the program. */
static int pc_read_file(char *place, size_t room)
{
    char path[1100], line[400], value[280];
    char *slash;
    FILE *file;
    int found = 0;
#ifdef _WIN32
    DWORD size = GetModuleFileNameA(NULL, path, 1000);
    if (!size || size >= 1000)
        return 0;
    slash = strrchr(path, '\\');
#else
    ssize_t size = readlink("/proc/self/exe", path, 1000);
    if (size <= 0 || size >= 1000)
        return 0;
    path[size] = 0;
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
    else if (!pc_read_file(place, room))
        snprintf(place, room, "127.0.0.1:" PC_PORT);
}

#ifdef PC_IN_PROCESS
/* Connect to the machines in this process; every place is a client of its own. */
static int pc_connect(pc_connection *made, const char *place, int wait_ms, int nobody)
{
    static pc_socket last;
    int code;
    (void)wait_ms;
    if (!pc_python())
        return nobody;
    code = pc_greet(++last, nobody);
    if (code) {
        pc_shut(last);
        return code;
    }
    made->socket = last;
    made->state = PC_OPEN;
    made->serial = 0;
    snprintf(made->place, sizeof made->place, "%s", place);
    return 0;
}

#else
/* Connect to a place; 0 and an open connection, or the code why not. */
static int pc_connect(pc_connection *made, const char *place, int wait_ms, int nobody)
{
    struct addrinfo asked, *found = NULL, *each;
    char host[260], port[16];
    int code = nobody;
    memset(&asked, 0, sizeof asked);
    asked.ai_socktype = SOCK_STREAM;
    if (!pc_split(place, host, sizeof host, port, sizeof port) || getaddrinfo(host, port, &asked, &found))
        return nobody;
    for (each = found; each; each = each->ai_next) {
        pc_socket reached = pc_reach(each, wait_ms);
        if (reached == PC_NO_SOCKET)
            continue;
        code = pc_greet(reached, nobody);
        if (code) {
            pc_shut(reached);
            break;
        }
        made->socket = reached;
        made->state = PC_OPEN;
        made->serial = 0;
        snprintf(made->place, sizeof made->place, "%s", place);
        break;
    }
    freeaddrinfo(found);
    return code;
}

#endif

/* Return the number of an open connection to a place; *code says why there is none (-1). `pc_all` is held. */
static int pc_open(const char *place, int wait_ms, int nobody, int *code)
{
    int k, empty = -1;
    for (k = 0; k < PC_CONNECTIONS; k++) {
        pc_connection *each = &pc_connections[k];
        if (each->state == PC_OPEN && !strcmp(each->place, place))
            return k;
        if (empty < 0 && each->state != PC_OPEN && !each->handles)
            empty = k;
    }
    *code = nobody;
    if (empty < 0)
        return -1;
    pc_enter(&pc_connections[empty].lock);
    *code = pc_connect(&pc_connections[empty], place, wait_ms, nobody);
    pc_leave(&pc_connections[empty].lock);
    return *code ? -1 : empty;
}

/* The connection of calls without a handle; a lost one comes back with a call that opens. `pc_all` is held. */
static int pc_usual(int opens, int *code)
{
    char place[280];
    int made;
    if (pc_default >= 0 && pc_connections[pc_default].state == PC_OPEN)
        return pc_default;
    if (pc_default >= 0 && !opens) {
        *code = PC_CODE_LOST;
        return -1;
    }
    pc_where(place, sizeof place);
    made = pc_open(place, PC_WAIT_MS, opens ? PC_CODE_NOBODY : PC_CODE_LOST, code);
    if (made >= 0)
        pc_default = made;
    return made;
}

/* Tell whether a connection is there still; one that the other side has ended is shut. */
static int pc_live(pc_connection *on)
{
    int live;
    pc_enter(&on->lock);
    if (on->state == PC_OPEN && pc_ended(on->socket)) {
        pc_shut(on->socket);
        on->state = PC_LOST;
    }
    live = on->state == PC_OPEN;
    pc_leave(&on->lock);
    return live;
}

/* The connection of a call that opens, the usual one without a place: a new one if that of before has been ended. */
static int pc_opened(const char *place, int wait_ms, int *code)
{
    int made, tries;
    for (tries = 0; tries < 2; tries++) {
        pc_enter(&pc_all);
        pc_begin();
        made = place ? pc_open(place, wait_ms, PC_CODE_LOST, code) : pc_usual(1, code);
        pc_leave(&pc_all);
        if (made < 0 || pc_live(&pc_connections[made]))
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
            size = each->to ? each->room : PC_NULL;
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
static int pc_exchange(pc_connection *on, uint16_t number, const pc_argument *given, int count, pc_result *result)
{
    unsigned char frame[PC_MOST];
    uint32_t size;
    uint16_t heard[2];
    int code = PC_CODE_LOST;
    pc_enter(&on->lock);
    if (on->state == PC_OPEN) {
        uint16_t serial = ++on->serial;
        size = pc_pack(frame, number, serial, given, count);
        if (!size) {
            pc_leave(&on->lock);
            return PC_CODE_NULL;
        }
        if ((size = pc_round(on->socket, frame, size)) != 0) {
            memcpy(heard, frame + 4, 4);
            if (heard[0] == number && heard[1] == serial && pc_unpack(frame, size, given, count)) {
                memcpy(&result->whole, frame + 12, 8);
                memcpy(&result->real, frame + 12, 8);
                code = 0;
            }
        }
        if (code) {
            pc_shut(on->socket);
            on->state = PC_LOST;
        }
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
    if (pc_handles[handle].connection) {
        pc_connections[pc_handles[handle].connection - 1].handles--;
        pc_handles[handle].connection = 0;
    }
    pc_leave(&pc_all);
}

/* Carry out a call that reaches its machine through a handle, its first argument. */
static pc_result pc_through(uint16_t number, int way, pc_argument *given, int count)
{
    uint16_t handle, there;
    pc_result result = {0, 0, 0};
    int connection, code;
    memcpy(&handle, given[0].from, 2);
    pc_enter(&pc_all);
    pc_begin();
    connection = pc_handles[handle].connection - 1;
    there = pc_handles[handle].there;
    pc_leave(&pc_all);
    if (connection < 0)
        return pc_coded(PC_CODE_HANDLE);
    given[0].from = &there;
    code = pc_exchange(&pc_connections[connection], number, given, count, &result);
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
    int connection, code = 0;
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
        connection = -1;
        if (given[0].from && wait_s >= 0 && port && given[0].size <= 256) {
            const char *name = (const char *)given[0].from;
            snprintf(place, sizeof place, strchr(name, ':') ? "[%s]:%u" : "%s:%u", name, (unsigned)port);
            connection = pc_opened(place, wait_s ? wait_s > 600 ? 600000 : wait_s * 1000 : -1, &code);
        }
    } else
        connection = pc_opened(NULL, 0, &code);
    if (connection < 0)
        return pc_coded(code);
    code = pc_exchange(&pc_connections[connection], number, given, count, &result);
    if (code || result.whole)
        return code ? pc_coded(code) : result;
    pc_enter(&pc_all);
    here = pc_name(connection, there);
    pc_leave(&pc_all);
    if (!here)
        return pc_coded(PC_CODE_HANDLE);
    memcpy(to, &here, sizeof here);
    return result;
}
#endif

static pc_result pc_call(uint16_t number, int way, pc_argument *given, int count)
{
    pc_result result = {0, 0, 0};
    int connection, code = 0;
#if PC_HANDLES
    if (way == PC_THROUGH || way == PC_FREES)
        return pc_through(number, way, given, count);
    if (way == PC_OPENS || way == PC_OPENS_AT)
        return pc_opening(number, way, given, count);
#endif
    if (way == PC_OPENS)
        connection = pc_opened(NULL, 0, &code);
    else {
        pc_enter(&pc_all);
        pc_begin();
        connection = pc_usual(0, &code);
        pc_leave(&pc_all);
    }
    if (connection >= 0) {
        int counted = pc_calls_begin();
        code = pc_exchange(&pc_connections[connection], number, given, count, &result);
        pc_calls_end(counted);
        if (way == PC_OPENS && !code && !result.whole)
            pc_listen_again();
    }
    return code ? pc_coded(code) : result;
}
