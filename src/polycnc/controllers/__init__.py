"""The rebuilt controllers, one package each: their state, their functions, codes and limits."""
