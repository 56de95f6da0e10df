"""Servers: each speaks one protocol about controls; a core without sockets, and a thin shell around it."""
