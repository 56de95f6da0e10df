"""Run the command as ``python -m polycnc.cli``."""

from polycnc.cli import main

main()
