"""What there is to say of a database."""

from pathlib import Path
from typing import Any

from quatfilt.cli import _output
from quatfilt.reconstruction.database import MotionDatabase

_MEGABYTE = 1e6


def describe(path: Path, db: MotionDatabase) -> dict[str, Any]:
    """Return what programs want to know of a database."""
    lengths = db.starts[1:] - db.starts[:-1]
    return {
        "file": str(path),
        "bytes": path.stat().st_size,
        "poses": len(db),
        "fps": db.fps,
        "seconds": len(db) / db.fps,
        "up": "xyz"[db.up],
        "unit_centimetres": db.skeleton.centimetres_per_unit,
        "skeletons": len(db.skeletons),
        "graph_degree": 0 if db.graph is None else db.graph.shape[1],
        "joints": [
            {"name": name, "weight": float(weight)}
            for name, weight in zip(db.names, db.joint_weights, strict=True)
        ],
        "clips": [
            {"name": name, "poses": int(poses), "skeleton": int(skeleton)}
            for name, poses, skeleton in zip(db.clip_names, lengths, db.skeleton_indices, strict=True)
        ],
        "notes": list(db.notes),
    }


def summary(path: Path, db: MotionDatabase) -> str:
    """Return a line for people."""
    counts = (
        f"{_output.counted(len(db), 'pose')} of {_output.counted(len(db.names), 'joint')}",
        f"{_output.counted(len(db.clip_names), 'clip')} of {_output.counted(len(db.skeletons), 'skeleton')}",
        f"{db.fps:g} frames per second",
        f"{len(db) / db.fps / 60:.3g} min",
        f"{path.stat().st_size / _MEGABYTE:.3g} MB",
    )
    return f"{path}: {', '.join(counts)}"
