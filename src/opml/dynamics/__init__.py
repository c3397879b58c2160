"""Forces, the integrator and the ensemble, which propagates many arcs at once; `kernels` is compiled."""
