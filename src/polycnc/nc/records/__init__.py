"""Block records: what is known of a block while it is executed."""
