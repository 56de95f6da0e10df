"""The ordinary interpreter: modal state, coordinates, compensation, cycles, and what it queues."""
