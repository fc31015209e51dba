"""A block of runs from its initial states to its end."""
