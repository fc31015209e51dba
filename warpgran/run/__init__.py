"""A study from its cases to its results."""
