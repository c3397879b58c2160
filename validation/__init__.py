"""opml's dynamics held against Orekit's: the same inputs on both sides, term by term and end to end."""
