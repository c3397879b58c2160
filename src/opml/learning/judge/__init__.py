"""What a model is worth: P_ML, intervals, calibration, sizes of what is left."""
