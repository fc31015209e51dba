"""`warpgran reproduce`: the figures and claims of the paper, computed anew."""
