# SPDX-License-Identifier: BSD-3-Clause
"""A dataset of your own: arrays are written in the TUM layout, and the odometry runs on them. The arrays are computed here: a
camera moves at 0.6 m/s to the right, 2 m in front of a textured wall.

custom_dataset.py FOLDER
"""

import sys
from pathlib import Path

import numpy as np

import stillpoint
from stillpoint import InputError, eval as sp

FRAMES, INTERVAL_S, FOCAL_PX, DISTANCE_M, SHIFT_PX = 40, 1 / 30, 200.0, 2.0, 2
SIZE = (240, 320)


def texture(column):
    """Gray image [240, 320] of blocks with pseudo-random brightness, from a column of the wall on."""
    rows, columns = np.indices(SIZE)
    blocks = (rows // 8).astype(np.uint64) * 7919 + (columns + column).astype(np.uint64) // 8
    return ((blocks * 2654435761 >> 24) & 255).astype(np.uint8)


def write_image(path, pixels, maximum):
    """PGM, of 16 bits if `maximum` exceeds 255."""
    data = pixels.astype(">u2" if maximum > 255 else np.uint8).tobytes()
    path.write_bytes(f"P5\n{pixels.shape[1]} {pixels.shape[0]}\n{maximum}\n".encode() + data)


def write_sequence(folder):
    """Images, their lists, calibration and ground truth."""
    for name in ("rgb", "depth"):
        (folder / name).mkdir(parents=True)
    times_s = 100.0 + INTERVAL_S * np.arange(FRAMES)
    for name, pixels, maximum in (("rgb", texture, 255), ("depth", lambda _: np.full(SIZE, 5000 * DISTANCE_M), 65535)):
        lines = []
        for index, t in enumerate(times_s):
            write_image(folder / name / f"{t:.6f}.pgm", pixels(SHIFT_PX * index), maximum)
            lines.append(f"{t:.6f} {name}/{t:.6f}.pgm\n")
        (folder / f"{name}.txt").write_text("".join(lines))
    positions = np.zeros((FRAMES, 3))
    positions[:, 0] = SHIFT_PX * DISTANCE_M / FOCAL_PX * np.arange(FRAMES)
    truth = sp.Trajectory.from_seconds(times_s, positions, np.tile([0.0, 0.0, 0.0, 1.0], (FRAMES, 1)))
    sp.write_tum(truth, folder / "groundtruth.txt")
    (folder / "rig.toml").write_text(
        f"[camera]\nwidth = {SIZE[1]}\nheight = {SIZE[0]}\nfx = {FOCAL_PX}\nfy = {FOCAL_PX}\ncx = 159.5\ncy = 119.5\n")
    return truth


def main(arguments):
    if len(arguments) != 1:
        sys.exit(__doc__)
    truth = write_sequence(Path(arguments[0]))
    run = stillpoint.run(arguments[0], "vo", {"detector.kind": "none"})
    if run.trajectory is None:
        sys.exit("custom_dataset: error: no frame was located")
    error = sp.evaluate("strict:se3", truth, run.trajectory).ate_m
    print(f"{len(run.trajectory)} of {FRAMES} frames located, ATE {error.rmse:.4f} m")


if __name__ == "__main__":
    try:
        main(sys.argv[1:])
    except (InputError, FileExistsError) as error:
        sys.exit(f"custom_dataset: error: {error}")
