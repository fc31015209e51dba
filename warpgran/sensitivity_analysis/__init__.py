"""Which parameters matter: indices of a design of runs, what they must not be read without, tables and figures."""
