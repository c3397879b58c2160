"""The tools that fly the same arcs, each behind the same face.

A peer is a class with

* `title`, `model`, `method` and `way`: what it flew with, for the report;
* `settings`: five ways to fly from coarse to fine, by what the report calls them; `raced`: which of them
  stands for the tool in the race; `tight`: two ways with next to no error of the integration, the second
  the tighter;
* `pressure`: whether it has radiation pressure;
* `share`: how many of a hundred arcs it flies in the race, fewer for a slow one; `sample`: how many at each
  of its settings;
* `fly(arcs, setting)`: the states (n, 6) at the ends of the arcs, GCRF [m, m/s], `setting` being one of
  `settings` or `tight`; `twin(arcs)`: the same by opml under what the two models share.

It loads its tool when it is made, so that a tool that is absent costs its own row only. The tools that fit
the same tracks are in `benchmarks.fitters`.
"""

from importlib import import_module
from typing import Any

FLYERS = {
    "opml": "benchmarks.peers.ours:Opml",
    "satkit_gauss_jackson": "benchmarks.peers.satkit:GaussJackson",
    "satkit": "benchmarks.peers.satkit:RungeKutta",
    "heyoka": "benchmarks.peers.heyoka:Heyoka",
    "orekit": "benchmarks.peers.orekit:Orekit",
}
"""Where each peer's class stands."""

_WORDS = ("title", "model", "method", "way", "raced", "pressure", "share", "sample")
_KINDS = ("settings", "tight")


def load(location: str) -> type:
    """Return the class of a peer. Raises ImportError where its tool is not installed."""
    module, cls = location.split(":")
    return getattr(import_module(module), cls)


def about(peer: Any) -> dict[str, Any]:
    """Return what a report needs to know of a peer, and the names of its settings, where it has any."""
    words = {word: getattr(peer, word) for word in _WORDS if hasattr(peer, word)}
    return words | {kind: list(getattr(peer, kind)) for kind in _KINDS if hasattr(peer, kind)}
