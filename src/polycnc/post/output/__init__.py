"""From the records of a tool path to the blocks of a program."""
