"""A benchmark of orbit prediction: tasks, answers of any tool, and what they are worth."""
