"""The function library of the card, a module for each chapter of it."""
