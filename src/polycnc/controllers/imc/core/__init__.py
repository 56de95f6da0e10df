"""The card's control cycle: parameter memory, queues, events, coupling, homing, on arrays, compiled."""
