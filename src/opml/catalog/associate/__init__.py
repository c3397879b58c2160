"""Which tracks belong to an object: foreign ones, and those behind a burn."""
