"""The ground floor, which knows no orbits: errors, files, time, seeds, digests of code, compiled kernels."""
