"""What a model is worth: P_ML, intervals, calibration, sizes of the errors left."""
