"""Run the command as ``python -m polycnc``."""

from polycnc.cli import main

main()
