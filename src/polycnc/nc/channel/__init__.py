"""A channel: reading, calls and preparation of one program for one path."""
