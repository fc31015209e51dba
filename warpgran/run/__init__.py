"""Computing a study: on the threads of this machine or on a cluster, in memory or into a file."""
