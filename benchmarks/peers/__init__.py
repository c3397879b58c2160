"""The tools that fly the same arcs, each behind the same face.

A peer is a class with `title`, `model` and `integrator` (what it flew with, for the report), `share` (how
many of a hundred arcs it flies, fewer for a slow one), `fly(arcs)` and `fly_tightly(arcs)`, which return the
states (n, 6) at the ends of the arcs, GCRF [m, m/s]; `fly_tightly` with settings that leave no error of the
integration to speak of. `twin(arcs)` gives the same states by opml under what the two models share. It loads
its tool when it is made, so that a tool that is absent costs its own row only.
"""

from importlib import import_module

PEERS = {
    "opml": "benchmarks.peers.ours:Opml",
    "satkit_gauss_jackson": "benchmarks.peers.satkit:GaussJackson",
    "satkit": "benchmarks.peers.satkit:RungeKutta",
    "heyoka": "benchmarks.peers.heyoka:Heyoka",
    "orekit": "benchmarks.peers.orekit:Orekit",
}
"""Where each peer's class stands."""


def load(name: str) -> type:
    """The class of a peer. Raises ImportError where its tool is not installed."""
    module, cls = PEERS[name].split(":")
    return getattr(import_module(module), cls)
