"""``quatfilt info``: contents and defects of a file."""

from typing import Any

import numpy as np

from quatfilt import sampling
from quatfilt.cli import _options, _output
from quatfilt.motion.defects import find_defects
from quatfilt.motion.motion import Motion
from quatfilt.noise.model import noise_model

_SHOWN = 10


def info(
    path: _options.Input,
    *,
    fps: _options.Fps = None,
    skeleton: _options.SkeletonFile = None,
    first_frame: _options.FirstFrameChoice = "auto",
    json: _options.Json = False,
) -> None:
    """Show the contents of a motion file and its noise.

    The noise of a joint is the estimated deviation per component of its rotation vector. A spike is a sample far
    from both of its neighbours; a jump is a rotation of more than 15 degrees in a frame at 120 frames per second. Where the
    source did not measure every frame, its rate and frozen stretches are shown.
    """
    with _output.busy(f"reading {path.name}"):
        motion = _options.read(path, fps=fps, skeleton=skeleton, first_frame=first_frame)
    report = {"file": str(path), **describe(motion)}
    if json:
        _output.print_json(report)
        return
    joints = report["joints"]
    _output.say(
        f"{path}: {_output.counted(report['frames'], 'frame')} of {_output.counted(len(joints), 'joint')}, "
        f"{report['fps']:g} frames per second, {report['seconds']:.3g} s"
    )
    for note in motion.notes:
        _output.say(f"  {note}")
    if report["unit_centimetres"] != 1:
        _output.say(f"  one unit is {report['unit_centimetres']:.4g} cm")
    counts = (
        _output.counted(report["missing_samples"], "missing sample"),
        _output.counted(report["missing_positions"], "missing root position"),
        _output.counted(report["spikes"], "spike"),
        _output.counted(report["jumps"], "jump"),
        _output.counted(report["frozen_frames"], "frozen frame"),
    )
    _output.say(f"  estimated noise {report['noise_degrees']:.2g}° (root mean square over the joints)")
    for name, value in report["noise_model"].items():
        _output.say(f"  noise, {name}: {value}")
    _output.say(f"  {', '.join(counts)}")
    if report["source"]["says"]:
        _output.say(f"  {report['source']['says']}")
    if report["flips"]:
        _output.say(
            f"  {_output.counted(report['flips'], 'flip')} of the whole body: the root turns by more than 90° in a frame"
        )
    worst = sorted(
        joints,
        key=lambda joint: (
            joint["spikes"] + joint["jumps"] + joint["missing_samples"],
            joint["noise_degrees"],
        ),
        reverse=True,
    )[:_SHOWN]
    if not worst or not report["frames"]:
        return
    _output.say("")
    _output.print_table(
        ("joint", "noise °", "largest step °", "missing", "spikes", "jumps"),
        [
            (
                joint["name"],
                _output.number(joint["noise_degrees"], 3),
                _output.number(joint["largest_step_degrees"], 1),
                str(joint["missing_samples"]),
                str(joint["spikes"]),
                str(joint["jumps"]),
            )
            for joint in worst
        ],
        title="Worst joints" if len(joints) > _SHOWN else "Joints",
    )


def describe(motion: Motion) -> dict[str, Any]:
    """Return what `info` says about a motion."""
    defects = find_defects(motion.rotations, fps=motion.fps)
    model = noise_model(motion)
    noise = np.degrees(model.joint_level)
    source = sampling.recognised(motion.rotations, motion.fps)
    spikes, jumps = defects.spikes.sum(axis=0), defects.jumps.sum(axis=0)
    return {
        "frames": len(motion),
        "fps": motion.fps,
        "seconds": len(motion) / motion.fps,
        "unit_centimetres": motion.skeleton.centimetres_per_unit,
        "notes": list(motion.notes),
        "noise_degrees": float(np.sqrt(np.mean(noise**2))) if len(noise) else 0.0,
        "noise_model": dict(model.describe()),
        "missing_samples": int(defects.missing.sum()),
        "missing_positions": int(np.count_nonzero(np.isnan(motion.translation).any(axis=1))),
        "spikes": int(spikes.sum()),
        "jumps": int(jumps.sum()),
        "frozen_frames": defects.frozen,
        "flips": sampling.flips(motion.rotations),
        "source": {
            "kind": source.kind,
            "frames_between_measurements": source.spacing,
            "measurements_per_second": motion.fps / source.spacing,
            "frozen_stretches": source.freezes,
            "says": source.says(motion.fps),
        },
        "joints": [
            {
                "name": name,
                "noise_degrees": float(noise[joint]),
                "largest_step_degrees": float(defects.fastest[joint]),
                "missing_samples": int(defects.missing[joint]),
                "spikes": int(spikes[joint]),
                "jumps": int(jumps[joint]),
            }
            for joint, name in enumerate(motion.skeleton.names)
        ],
    }


__all__ = ["describe", "info"]
