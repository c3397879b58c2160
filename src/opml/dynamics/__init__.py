"""Forces, the integrator and the ensemble that flies many arcs at once; `kernels` has what is compiled."""
