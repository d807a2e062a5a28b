# SPDX-License-Identifier: GPL-3.0-or-later
"""Plots a session: answers with the fitted functions, and both curves. plot_curves.py SESSION OUT.png"""
import sys

import matplotlib.pyplot as plt
import numpy as np
import todbench as tb


def main(folder, out):
    session = tb.open_session(folder)
    figure, (answers, curves) = plt.subplots(1, 2, figsize=(11, 4.5), layout="constrained")
    for colour, point in enumerate(session.curve.points):
        size, correct, total, _ = point.levels
        levels = np.unique(size)
        share = [correct[size == one].sum() / total[size == one].sum() for one in levels]
        answers.plot(levels, share, "o", color=f"C{colour}", label=f"{point.set_delta_t_k:g} K")
        if point.fit.threshold and point.fit.slope:
            x = np.geomspace(levels[0], levels[-1], 200)
            answers.plot(x, tb.psychometric(x, point.fit.threshold, point.fit.slope), color=f"C{colour}")
    answers.set(xscale="log", xlabel="size [mrad]", ylabel="proportion correct", ylim=(0.2, 1.02))
    answers.xaxis.set_minor_formatter("{x:g}")
    answers.legend()
    for curve, name, style in ((session.curve, "measured", "o-"), (session.twin, "simulated", "s--")):
        points = [point for point in curve.points if point.fit.usable] if curve else []
        if points:
            acuity = np.array([point.fit.acuity_per_mrad for point in points])
            ends = np.array([point.fit.acuity_ci95 for point in points]).T
            curves.errorbar(acuity, [abs(point.delta_t_k) for point in points], xerr=np.abs(ends - acuity), fmt=style,
                            capsize=3, label=name)
    curves.set(yscale="log", xlabel="acuity [1/mrad]", ylabel="contrast [K]", title=session.curve.sensor)
    curves.legend()
    figure.savefig(out, dpi=100)


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2])
