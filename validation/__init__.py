"""opml's dynamics held against Orekit's, term by term and end to end; `folders`: results against results."""
