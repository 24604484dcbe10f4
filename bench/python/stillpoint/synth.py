# SPDX-License-Identifier: BSD-3-Clause
"""Rendered sequences with exact ground truth: a preset and its settings give the same bits as `stillpoint data synth`.

    sequence = render("walking_xyz", seconds=2, width=320, height=240, walkers=1, labels=True)
    for frame in sequence:                       # a stillpoint.datasets.Sequence
        frame.color, frame.gray, frame.depth     # uint8 [h, w, 3], uint8 [h, w], uint16 [h, w]
    sequence.camera_truth, sequence.gyro, sequence.motion_labels(0)
"""

from . import InputError, _synth
from ._synth import ColorSensor, DepthSensor, DetectorModel, ImuSensor, Request, preset_names
from .datasets import open_sequence

__all__ = ["ColorSensor", "DepthSensor", "DetectorModel", "ImuSensor", "InputError", "Request", "preset", "preset_names", "render"]


def preset(name, **settings):
    """The Request of a preset, with fields of Request as `settings`. With `width` but no `focal_px` the field of view remains.

    Raises InputError if there is no such preset.
    """
    request = _synth.preset_request(name)
    if "width" in settings and "focal_px" not in settings:
        settings["focal_px"] = settings["width"] * (request.focal_px / request.width)
    for key, value in settings.items():
        if not hasattr(request, key):
            raise TypeError(f'unknown setting "{key}"; Request has the fields {", ".join(Request.__fields__)}')
        setattr(request, key, value)
    return request


def render(request, out=None, threads=0, **settings):
    """Renders a sequence and opens it: a Sequence, whose frames are numpy arrays.

    request: a Request, or the name of a preset with its `settings`; out: folder to create, else the cache of the program, which
    keeps the sequence; threads: 0 = one per processor. Raises InputError for settings out of range, or if `out` exists.
    """
    if isinstance(request, str):
        request = preset(request, **settings)
    elif settings:
        raise InputError("settings: are those of a preset; change the fields of the request instead")
    if out is None:
        return open_sequence(_synth.render_cached(request, threads))
    _synth.render_into(request, out, threads)
    return open_sequence(out)
