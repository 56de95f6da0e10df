"""The virtual board: its axes, variables, system file and commands, by the manual's names."""
