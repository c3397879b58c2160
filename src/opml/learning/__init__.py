"""Learning the orbit prediction error: dataset, cleaning, splits, learners and the performance metric."""
