"""The board's scan: profiles, spoolers, look-ahead, limits, latches, on arrays, compiled."""
