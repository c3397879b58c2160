"""opml's speed: beside public propagators on the same arcs, its own scaling, and what each kernel costs."""

import warnings

warnings.simplefilter("error")  # as in the tests
