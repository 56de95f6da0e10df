"""The PC around the board: slots, booting, what is installed."""
