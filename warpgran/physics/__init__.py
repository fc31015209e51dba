"""The model and its scheme in NumPy, without Warp: what the kernels are compared with."""
