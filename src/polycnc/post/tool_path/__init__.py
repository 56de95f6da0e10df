"""Tool paths: the formats that are read, their records, and the sweep they mean."""
