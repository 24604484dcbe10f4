# SPDX-License-Identifier: BSD-3-Clause
"""The table of a store in pandas, and a box plot of one metric per sequence and variant. Needs pandas and matplotlib.

plot_store.py STORE FIGURE [METRIC]
"""

import sys

import matplotlib

matplotlib.use("Agg")  # writes files, needs no display
from matplotlib import pyplot

from stillpoint import InputError, store


def main(arguments):
    if len(arguments) not in (2, 3):
        sys.exit(__doc__)
    metric = arguments[2] if len(arguments) == 3 else "ate_rmse_m"
    runs = store.Store(arguments[0]).frame()
    if metric not in runs:
        sys.exit(f"plot_store: error: no run has the metric {metric}; there are {', '.join(runs.columns[17:])}")
    print(runs.groupby(["sequence", "variant"])[metric].describe()[["count", "min", "50%", "max"]])
    figure, axes = pyplot.subplots(layout="constrained")
    runs.boxplot(metric, by=["sequence", "variant"], ax=axes, vert=False)  # long names do not overlap
    axes.set(title="", xlabel=metric, ylabel="")
    figure.suptitle("")
    figure.savefig(arguments[1])


if __name__ == "__main__":
    try:
        main(sys.argv[1:])
    except InputError as error:
        sys.exit(f"plot_store: error: {error}")
