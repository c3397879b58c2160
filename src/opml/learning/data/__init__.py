"""Training data: the dataset, its cleaning, the rows of a split."""
