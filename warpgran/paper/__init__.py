"""`warpgran reproduce`: the figures and claims of the paper, from the run files in runs/paper/."""
