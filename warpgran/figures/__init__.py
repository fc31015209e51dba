"""Figures, animations and pages of results."""
