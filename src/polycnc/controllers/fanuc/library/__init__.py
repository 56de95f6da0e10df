"""The function library: codes, structures, sessions, functions."""
