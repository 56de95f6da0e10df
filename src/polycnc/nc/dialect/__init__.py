"""Dialects: which code does what on a control."""
