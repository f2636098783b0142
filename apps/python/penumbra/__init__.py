"""Visual SLAM that sees half-hidden things, on the CPU. See docs/python.md."""

from ._penumbra import (
    Instance,
    Rig,
    Segmenter,
    Slam,
    State,
    TrackResult,
    __version__,
    evaluate,
    read_trajectory,
)

__all__ = [
    "Instance",
    "Rig",
    "Segmenter",
    "Slam",
    "State",
    "TrackResult",
    "__version__",
    "evaluate",
    "read_trajectory",
]
