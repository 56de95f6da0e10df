/* What all parts share: the system's sockets, locks, conditions and time; arguments and results. */
#ifdef _WIN32
#define _WIN32_WINNT 0x0600
#include <winsock2.h>
#include <ws2tcpip.h>
#else
#define _GNU_SOURCE 1 /* dladdr */
#define _DARWIN_C_SOURCE 1
#ifdef PC_IN_PROCESS
#define PY_SSIZE_T_CLEAN
#include <Python.h>
#endif
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <pthread.h>
#include <sched.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/types.h>
#include <time.h>
#include <unistd.h>
#endif
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
#error "the structures of this library are those of little-endian machines"
#endif

#define PC_MOST 66560u      /* bytes of a frame: as many as 16 bits count, and what is beside them */
#define PC_MOST_ROOM 65540u /* bytes of an output */
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
typedef CONDITION_VARIABLE pc_condition;
#define PC_NO_SOCKET INVALID_SOCKET
#define PC_UNLOCKED SRWLOCK_INIT
#define PC_UNCHANGED CONDITION_VARIABLE_INIT
#define pc_enter(lock) AcquireSRWLockExclusive(lock)
#define pc_leave(lock) ReleaseSRWLockExclusive(lock)
#define pc_wake(condition) WakeAllConditionVariable(condition)
#define pc_shut(socket) closesocket(socket)
#define PC_SEND_FLAGS 0

static int pc_wait(pc_condition *changed, pc_lock *lock, int wait_ms)
{
    return SleepConditionVariableSRW(changed, lock, (DWORD)wait_ms, 0) != 0;
}

PC_UNUSED static int64_t pc_now_ms(void)
{
    return (int64_t)GetTickCount64();
}
#else
typedef int pc_socket;
typedef pthread_mutex_t pc_lock;
typedef pthread_cond_t pc_condition;
#define PC_NO_SOCKET (-1)
#define PC_UNLOCKED PTHREAD_MUTEX_INITIALIZER
#define PC_UNCHANGED PTHREAD_COND_INITIALIZER
#define pc_enter(lock) pthread_mutex_lock(lock)
#define pc_leave(lock) pthread_mutex_unlock(lock)
#define pc_wake(condition) pthread_cond_broadcast(condition)
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

/* Wait until a condition is woken, for a time; 0 when that is over. */
static int pc_wait(pc_condition *changed, pc_lock *lock, int wait_ms)
{
    struct timespec until;
    clock_gettime(CLOCK_REALTIME, &until);
    until.tv_sec += wait_ms / 1000;
    until.tv_nsec += wait_ms % 1000 * 1000000L;
    if (until.tv_nsec >= 1000000000L) {
        until.tv_sec++;
        until.tv_nsec -= 1000000000L;
    }
    return pthread_cond_timedwait(changed, lock, &until) == 0;
}

PC_UNUSED static int64_t pc_now_ms(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * 1000 + now.tv_nsec / 1000000;
}
#endif

enum { PC_VALUE, PC_READ, PC_WRITE, PC_BOTH };
enum { PC_PLAIN, PC_THROUGH, PC_OPENS, PC_OPENS_AT, PC_FREES };

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

/* How much of `size` bytes can be asked for: none of a negative number, never more than a frame holds. */
PC_UNUSED static uint32_t pc_size(int64_t size)
{
    return size < 0 ? 0 : size > (int64_t)PC_MOST ? PC_MOST : (uint32_t)size;
}

PC_UNUSED static uint32_t pc_least(int64_t size, uint32_t other)
{
    return pc_size(size) < other ? pc_size(size) : other;
}

/* A handle that is a number; 0xFFFFFFFF, which is none, of an address that has more bits. */
PC_UNUSED static uint32_t pc_opaque(const void *handle)
{
    return (uint64_t)(uintptr_t)handle >> 32 ? 0xFFFFFFFFu : (uint32_t)(uintptr_t)handle;
}

/* A text with its zero; a longer one is cut by the other side. */
PC_UNUSED static uint32_t pc_text(const char *text)
{
    uint32_t size = 0;
    while (text && size < 4096 && text[size])
        size++;
    return text ? size + (size < 4096) : 0;
}

/* Write who calls. */
static void pc_introduce(unsigned char *hello)
{
    memset(hello, 0, PC_HELLO_SIZE);
    memcpy(hello, "PNCCALL1", 8);
    hello[8] = (unsigned char)sizeof(void *);
    hello[9] = PC_PACKING;
    memcpy(hello + 12, PC_NAME, sizeof PC_NAME - 1);
    memcpy(hello + 28, PC_VERSION, sizeof PC_VERSION - 1);
    memcpy(hello + 44, pc_table, sizeof pc_table);
}

/* Read what comes back: 0, or the code that the other side refuses the library with, or `nobody` of somebody else. */
static int pc_welcome(const unsigned char *answer, int nobody)
{
    int32_t code;
    if (memcmp(answer, "PNCCALL1", 8))
        return nobody;
    memcpy(&code, answer + 8, 4);
    return (int)code;
}
