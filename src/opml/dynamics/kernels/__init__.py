"""Compiled kernels, which know arrays and numbers alone: forces, the integrator's step, a block of arcs."""
