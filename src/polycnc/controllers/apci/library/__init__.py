"""The function library of the board, a module for each chapter of it."""
