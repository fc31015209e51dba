"""Which parameters matter: indices of a design of runs, what to know of them, tables and figures."""
