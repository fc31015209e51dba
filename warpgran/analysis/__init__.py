"""Quantities computed from a result."""
