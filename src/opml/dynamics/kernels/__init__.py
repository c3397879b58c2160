"""The compiled kernels: forces, the integrator's step, a block of arcs. They know arrays alone."""
