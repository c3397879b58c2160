"""What is learned from: the dataset, its cleaning, the rows of a split."""
