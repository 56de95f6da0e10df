"""What is in force: actions that codes stand for, modal values as columns, frames and placements."""
