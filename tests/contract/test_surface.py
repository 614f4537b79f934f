"""The two backends have the same functions with the same positional arguments."""

import inspect

import pytest
from quatfilt import _core, _reference

FILES = "reads or writes the text of a file, which is no arithmetic"

STREAMS = "the reference's filter of the whole clip defines the stream"

ONLY_IN_CORE = {
    "FormatError": FILES,
    "MotionTracker": STREAMS,
    "PoseStream": STREAMS,
    "SegmentWalk": "what `segment_walk` returns",
    "TrackerTables": "what trackers of the core share; the reference keeps nothing",
    "bilateral_stream": STREAMS,
    "get_num_threads": "the reference has no threads",
    "is_debug_build": "the reference is not built",
    "kalman_stream": STREAMS,
    "nonlocal_pose_means_stream": STREAMS,
    "one_euro_stream": STREAMS,
    "read_amc": FILES,
    "read_asf": FILES,
    "read_bvh": FILES,
    "set_num_threads": "the reference has no threads",
    "track_stream": STREAMS,
    "simd_level": "the reference leaves vector instructions to NumPy",
    "write_bvh": FILES,
}

ONLY_IN_REFERENCE: dict[str, str] = {}


def functions(module):
    return {name for name in module.__all__ if callable(getattr(module, name))}


def positional(function):
    return [
        parameter.name
        for parameter in inspect.signature(function).parameters.values()
        if parameter.kind in (parameter.POSITIONAL_ONLY, parameter.POSITIONAL_OR_KEYWORD)
    ]


def test_the_same_names():
    assert functions(_core) - functions(_reference) == set(ONLY_IN_CORE)
    assert functions(_reference) - functions(_core) == set(ONLY_IN_REFERENCE)


@pytest.mark.parametrize("name", sorted(functions(_core) & functions(_reference)))
def test_the_same_positional_arguments(name):
    core, reference = getattr(_core, name), getattr(_reference, name)
    assert positional(core) == positional(reference)
    assert len(inspect.signature(core).parameters) == len(positional(core)), "no keywords between the layers"
    assert len(inspect.signature(reference).parameters) == len(positional(reference))
