/* The machines are in this process, in an interpreter of Python: frames go to it. */
static PyObject *pc_inside; /* what answers, once there is an interpreter */
static pc_lock pc_starting = PC_UNLOCKED;
static int pc_is_child; /* whose interpreter has none of its threads any more */

/* Have an interpreter, that of the program if it has one, and the machines in it; 0 if that fails. */
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
        config.configure_c_stdio = 0; /* what the program has read ahead stays its own */
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
    PyGILState_STATE state;
    if (pc_is_child)
        return;
    state = PyGILState_Ensure();
    Py_XDECREF(PyObject_CallMethod(pc_inside, "shut", "i", client));
    PyErr_Clear();
    PyGILState_Release(state);
}

static int pc_ended(pc_socket client)
{
    (void)client; /* the machines end with the program */
    return 0;
}

static uint32_t pc_round(pc_socket client, unsigned char *frame, uint32_t size, int wait_ms)
{
    uint32_t have = pc_exchanged(client, frame, size, frame, PC_MOST), said = 0;
    (void)wait_ms;
    if (have >= PC_HEAD)
        memcpy(&said, frame, 4);
    return have >= PC_HEAD && said == have - 4 ? have : 0;
}

/* Connect to the machines in this process; every place is a client of its own. */
static pc_socket pc_connect(const char *place, int wait_ms, int nobody, int *code)
{
    static pc_socket last;
    pc_socket made = 0;
    unsigned char hello[PC_HELLO_SIZE], answer[12];
    (void)place;
    (void)wait_ms;
    *code = nobody;
    if (pc_is_child)
        return PC_NO_SOCKET;
    pc_enter(&pc_starting);
    if (pc_python())
        made = ++last;
    pc_leave(&pc_starting);
    if (!made)
        return PC_NO_SOCKET;
    pc_introduce(hello);
    if (pc_exchanged(made, hello, sizeof hello, answer, sizeof answer) == sizeof answer)
        *code = pc_welcome(answer, nobody);
    if (!*code)
        return made;
    pc_shut(made);
    return PC_NO_SOCKET;
}
