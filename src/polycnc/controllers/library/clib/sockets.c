/* The machines are served: frames go over a socket. Nothing waits longer than the program says, however slowly bytes
   come or go, except that whoever answers something has as long once more to answer all of it. */

/* When a wait has to be over; -1: never. */
static int64_t pc_until(int wait_ms)
{
    return wait_ms < 0 ? -1 : pc_now_ms() + wait_ms;
}

static int pc_left_ms(int64_t until)
{
    int64_t left = until - pc_now_ms();
    return until < 0 ? -1 : left < 0 ? 0 : (int)left;
}

/* Whether what comes or goes in parts takes too long, counted from the first part on: `until` begins as 0. */
static int pc_is_late(int64_t *until, int wait_ms)
{
    if (wait_ms < 0)
        return 0;
    if (!*until)
        *until = pc_until(wait_ms);
    return pc_now_ms() > *until;
}

static int pc_send(pc_socket socket, const unsigned char *bytes, uint32_t size, int wait_ms)
{
    int64_t until = 0;
    for (;;) {
        int sent = (int)send(socket, (const char *)bytes, (int)size, PC_SEND_FLAGS);
#ifndef _WIN32
        if (sent < 0 && errno == EINTR && !pc_is_late(&until, wait_ms))
            continue;
#endif
        if (sent <= 0)
            return 0;
        if ((uint32_t)sent == size)
            return 1;
        if (pc_is_late(&until, wait_ms))
            return 0;
        bytes += sent;
        size -= (uint32_t)sent;
    }
}

/* How often an answer is looked for before it is waited for, about a tenth of a millisecond in all: most answers come
   by then, and being woken takes longer. */
enum { PC_TRIES = 200 };

/* Receive some bytes, at most so many; 0 if nothing more comes. */
static uint32_t pc_some(pc_socket socket, unsigned char *bytes, uint32_t most, int64_t *until, int wait_ms)
{
    int got;
#ifdef _WIN32
    (void)until;
    (void)wait_ms;
    got = (int)recv(socket, (char *)bytes, (int)most, 0);
#else
    int tries;
    for (tries = 0; tries < PC_TRIES; tries++) {
        got = (int)recv(socket, (char *)bytes, most, MSG_DONTWAIT);
        if (got >= 0)
            return (uint32_t)got;
        sched_yield();
    }
    do
        got = (int)recv(socket, (char *)bytes, most, 0);
    while (got < 0 && errno == EINTR && !pc_is_late(until, wait_ms));
#endif
    return got > 0 ? (uint32_t)got : 0;
}

static int pc_receive(pc_socket socket, unsigned char *bytes, uint32_t size, int wait_ms)
{
    int64_t until = 0;
    for (;;) {
        uint32_t got = pc_some(socket, bytes, size, &until, wait_ms);
        if (!got)
            return 0;
        if (got == size)
            return 1;
        if (pc_is_late(&until, wait_ms))
            return 0;
        bytes += got;
        size -= got;
    }
}

/* Receive an answer, mostly in one go, since nothing follows it; its size, 0 if it is none. */
static uint32_t pc_answer(pc_socket socket, unsigned char *frame, int wait_ms)
{
    uint32_t have = 0, size = PC_HEAD, got;
    int64_t until = 0;
    while (have < size) {
        if ((have && pc_is_late(&until, wait_ms)) ||
            !(got = pc_some(socket, frame + have, PC_MOST - have, &until, wait_ms)))
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

/* Send a frame and receive its answer into its place; its size, 0 if it is none. */
static uint32_t pc_round(pc_socket socket, unsigned char *frame, uint32_t size, int wait_ms)
{
    return pc_send(socket, frame, size, wait_ms) ? pc_answer(socket, frame, wait_ms) : 0;
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

/* Let no send and no receive take longer; -1: for ever. */
static void pc_limit(pc_socket socket, int wait_ms)
{
#ifdef _WIN32
    DWORD limit = wait_ms < 0 ? 0 : wait_ms ? (DWORD)wait_ms : 1;
#else
    struct timeval limit;
    limit.tv_sec = wait_ms < 0 ? 0 : wait_ms / 1000;
    limit.tv_usec = wait_ms < 0 ? 0 : wait_ms ? wait_ms % 1000 * 1000 : 1;
#endif
    setsockopt(socket, SOL_SOCKET, SO_RCVTIMEO, (const void *)&limit, sizeof limit);
    setsockopt(socket, SOL_SOCKET, SO_SNDTIMEO, (const void *)&limit, sizeof limit);
}

#ifdef _WIN32
static int pc_connected(pc_socket made, const struct addrinfo *there, int64_t until)
{
    u_long on = 1, off = 0;
    fd_set written, failed;
    struct timeval wait;
    int wait_ms = pc_left_ms(until), done;
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
    return done;
}
#else
static int pc_connected(pc_socket made, const struct addrinfo *there, int64_t until)
{
    int flags = fcntl(made, F_GETFL, 0), done;
    struct pollfd asked;
    asked.fd = made;
    asked.events = POLLOUT;
    asked.revents = 0;
    fcntl(made, F_SETFD, FD_CLOEXEC);
    fcntl(made, F_SETFL, flags | O_NONBLOCK);
    done = connect(made, there->ai_addr, there->ai_addrlen) == 0;
    if (!done && (errno == EINPROGRESS || errno == EINTR)) {
        int found;
        do
            found = poll(&asked, 1, pc_left_ms(until));
        while (found < 0 && errno == EINTR);
        done = found == 1;
    }
    fcntl(made, F_SETFL, flags);
    return done;
}
#endif

/* Connect until a time. */
static pc_socket pc_reach(const struct addrinfo *there, int64_t until)
{
    pc_socket made = socket(there->ai_family, there->ai_socktype, there->ai_protocol);
    int error = 0, yes = 1;
    socklen_t size = sizeof error;
    if (made == PC_NO_SOCKET)
        return made;
    if (pc_connected(made, there, until) &&
        getsockopt(made, SOL_SOCKET, SO_ERROR, (void *)&error, &size) == 0 && !error) {
        setsockopt(made, IPPROTO_TCP, TCP_NODELAY, (const void *)&yes, sizeof yes);
#ifdef SO_NOSIGPIPE
        setsockopt(made, SOL_SOCKET, SO_NOSIGPIPE, &yes, sizeof yes);
#endif
        return made;
    }
    pc_shut(made);
    return PC_NO_SOCKET;
}

/* Say who calls; 0, or the code that the other side refuses it with, or `nobody` if there is none. */
static int pc_greet(pc_socket socket, int64_t until, int nobody)
{
    unsigned char hello[PC_HELLO_SIZE], answer[12];
    int left_ms = pc_left_ms(until);
    pc_limit(socket, left_ms);
    pc_introduce(hello);
    if (!pc_send(socket, hello, sizeof hello, left_ms) || !pc_receive(socket, answer, sizeof answer, left_ms))
        return nobody;
    return pc_welcome(answer, nobody);
}

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

/* Connect to a place; *code is 0, or says why not. */
static pc_socket pc_connect(const char *place, int wait_ms, int nobody, int *code)
{
    struct addrinfo asked, *found = NULL, *each;
    char host[260], port[16];
    int64_t until = pc_until(wait_ms);
    pc_socket made = PC_NO_SOCKET;
    *code = nobody;
    memset(&asked, 0, sizeof asked);
    asked.ai_socktype = SOCK_STREAM;
    if (!pc_split(place, host, sizeof host, port, sizeof port) || getaddrinfo(host, port, &asked, &found))
        return made;
    for (each = found; each && made == PC_NO_SOCKET; each = each->ai_next)
        made = pc_reach(each, until);
    freeaddrinfo(found);
    if (made == PC_NO_SOCKET)
        return made;
    *code = pc_greet(made, until, nobody);
    if (!*code) {
        pc_limit(made, wait_ms);
        return made;
    }
    pc_shut(made);
    return PC_NO_SOCKET;
}
