"""The scheme as Warp kernels, one file a stage; imports nothing but warp."""

if __name__ != "warpgran.kernels":
    raise ImportError(f"import this package as warpgran.kernels, not as {__name__}")
