"""Data of a Power Mate: parameters, increment systems, macro variables."""
