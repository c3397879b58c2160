"""The tools that fit the same tracks, each behind the same face.

A fitter is a class with

* `title`, `model`, `method` and `way`: what it fitted with, for the report;
* `share`: how many of the windows it fits, fewer for a slow one;
* `prepare(windows)`: finds out what must be known before these are fitted, and is not timed;
* `fit(windows)`: its answers; `twin(windows)`: opml's fits under what the two models share.
"""

FITTERS = {
    "opml": "benchmarks.fitters.ours:Opml",
    "orekit": "benchmarks.fitters.orekit:Orekit",
    "brahe": "benchmarks.fitters.brahe:Brahe",
}
"""Where each fitter's class stands."""
