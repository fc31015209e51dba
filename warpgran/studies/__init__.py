"""Questions that are answered by several runs: how fine a grid must be."""
