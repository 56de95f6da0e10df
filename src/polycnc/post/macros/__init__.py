"""The macro language and the control file that holds the macros."""
