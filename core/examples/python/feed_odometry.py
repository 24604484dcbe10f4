# SPDX-License-Identifier: BSD-3-Clause
"""Feeds the odometry from a loop of its own: inertial samples, frames and boxes of a sequence, as they would arrive from sensors.
Prints the pose of each located frame, its claimed standard deviation, and how many features are dynamic.

feed_odometry.py SEQUENCE [TRAJECTORY.tum]
"""

import sys

import numpy as np

import stillpoint
from stillpoint import InputError, datasets, eval as sp


def main(arguments):
    if len(arguments) not in (1, 2):
        sys.exit(__doc__)
    sequence = datasets.open_sequence(arguments[0])
    odometry = stillpoint.Odometry(sequence.rig)
    detector = stillpoint.RecordedDetector(sequence.detections)
    added, poses = 0, []
    for frame in sequence:
        needed = np.searchsorted(sequence.imu_times_ns, odometry.needs_imu_until(frame.t_ns), side="right") + 1
        new = slice(added, needed)
        odometry.add_imu_samples(sequence.imu_times_ns[new], sequence.gyro[new], sequence.accel[new])
        added = max(added, needed)
        update = odometry.track(frame, detector.detect(frame))
        if not update.is_located:
            continue
        poses.append((frame.t_ns, update.position, update.quaternion_xyzw))
        sigma = "" if update.covariance is None else f"  sigma {np.sqrt(np.trace(update.covariance[:3, :3])) * 1e3:.1f} mm"
        labels = odometry.features()["label"]
        dynamic = sum(label.startswith("dynamic") for label in labels)
        x, y, z = update.position
        print(f"{update.status}  ({x:+.3f}, {y:+.3f}, {z:+.3f}) m{sigma}  {dynamic} of {len(labels)} features dynamic")
    if len(arguments) == 2 and poses:
        times_ns, positions, quaternions = map(np.array, zip(*poses))
        sp.write_tum(sp.Trajectory(times_ns, positions, quaternions, "camera"), arguments[1])


if __name__ == "__main__":
    try:
        main(sys.argv[1:])
    except InputError as error:
        sys.exit(f"feed_odometry: error: {error}")
