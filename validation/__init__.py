"""opml's dynamics compared with Orekit's, term by term and end to end; `folders`: results against results."""

import warnings

warnings.simplefilter("error")  # as in the tests
