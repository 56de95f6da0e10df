"""The APCI-8001/8008 positioning and contouring board: profiles, spoolers, interpolation, its function library."""
