# SPDX-License-Identifier: BSD-3-Clause
"""Scores estimated trajectories against a ground truth: ATE and RPE by a protocol, and the worst moment of each.

score_files.py GROUND_TRUTH ESTIMATE...
"""

import sys

from stillpoint import InputError, eval as sp


def main(arguments):
    if len(arguments) < 2:
        sys.exit(__doc__)
    gt = sp.read_trajectory(arguments[0])
    for file in arguments[1:]:
        result = sp.evaluate("strict:se3", gt, sp.read_trajectory(file))
        if result.ate_m is None:
            sys.exit(f"score_files: error: {file}: no pose has a counterpart in the ground truth")
        worst = result.errors_m.argmax()
        seconds = (result.error_times_ns[worst] - gt.times_ns[0]) * 1e-9
        rpe = f"{result.rpe_m.rmse:.4f} m" if result.rpe_m else "n/a"
        print(f"{file}: ATE {result.ate_m.rmse:.4f} m, RPE {rpe} over 1 s, coverage {result.coverage:.2f}, "
              f"worst {result.errors_m[worst]:.4f} m at {seconds:.1f} s")


if __name__ == "__main__":
    try:
        main(sys.argv[1:])
    except InputError as error:
        sys.exit(f"score_files: error: {error}")
