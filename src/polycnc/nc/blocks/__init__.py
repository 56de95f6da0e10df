"""The reference interpreter: steps of a block, modal state, coordinates, compensation, cycles, and what it queues."""
