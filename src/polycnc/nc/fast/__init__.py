"""The compiled interpreter for runs of plain blocks."""
