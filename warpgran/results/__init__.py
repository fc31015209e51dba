"""Results: their layout, in memory and in files."""
