"""The virtual card and its card file."""
