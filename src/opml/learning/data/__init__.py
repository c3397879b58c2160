"""What models learn from: the dataset, its cleaning, the rows of a split."""
