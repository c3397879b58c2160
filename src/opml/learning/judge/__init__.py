"""Judges of models: P_ML, calibration, sizes of the residual errors."""
