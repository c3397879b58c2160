"""What knows nothing of orbits: errors, files, time, seeds, digests of code, how kernels are compiled."""
