"""Results, in memory and in files."""
