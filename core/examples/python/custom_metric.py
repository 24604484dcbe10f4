# SPDX-License-Identifier: BSD-3-Clause
"""A metric of your own over all runs of a store: the fraction of the path after which the position error stays above 1 cm,
with the paired difference between two variants.

custom_metric.py STORE BASE VARIANT
"""

import sys

import numpy as np

from stillpoint import InputError, eval as sp, store

LIMIT_M = 0.01


def path_until_error(gt, est):
    """Fraction of the path until the last pose whose error is within the limit."""
    matches = sp.PoseMatches(gt, est, sp.associate_tum(gt, est))
    errors_m, _ = sp.ate_errors(matches, sp.align(matches, "first_pose").S_w_v)
    path_m = sp.path_lengths(matches)
    good = np.flatnonzero(errors_m <= LIMIT_M)
    return path_m[good[-1]] / path_m[-1] if len(good) and path_m[-1] > 0 else 0.0


def main(arguments):
    if len(arguments) != 3:
        sys.exit(__doc__)
    results = store.Store(arguments[0])
    values = {}
    for run in results.runs():
        est, gt = results.trajectory(run), results.truth(run)
        if len(est) and len(gt):
            values.setdefault((run.sequence, run.seed, run.repetition), {})[run.variant] = path_until_error(gt, est)
    pairs = [(value[arguments[1]], value[arguments[2]]) for value in values.values() if {*arguments[1:]} <= set(value)]
    if not pairs:
        sys.exit("custom_metric: error: no run of both variants; the second and third argument name them")
    base, changed = zip(*pairs)
    result = sp.paired_difference(base, changed)
    print(f"{arguments[2]} - {arguments[1]}: {result.median:+.3f} over {result.count} pairs, p = {result.p_value:.3g}")


if __name__ == "__main__":
    try:
        main(sys.argv[1:])
    except InputError as error:
        sys.exit(f"custom_metric: error: {error}")
