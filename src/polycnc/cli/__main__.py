"""Run the command as ``python -m polycnc.cli``."""

from polycnc.cli._app import main

main()
