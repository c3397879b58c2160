"""Association of tracks with an object: foreign ones, and those behind a burn."""
