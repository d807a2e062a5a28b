# SPDX-License-Identifier: GPL-3.0-or-later
"""From a session folder to numbers and a figure, cell by cell: look_at_session.py SESSION [RECORDING] [--svg FILE]

With --fit PROGRAM the trials of the highest contrast are fitted again by `PROGRAM fit`.
"""
# %% What to look at
import argparse
import csv
import tempfile

import numpy as np

import todbench_session

arguments = argparse.ArgumentParser(description=__doc__)
arguments.add_argument("session")
arguments.add_argument("recording", nargs="?")
arguments.add_argument("--svg", help="write the TOD curve as a figure")
arguments.add_argument("--fit", metavar="PROGRAM", help="todbench, or its path")
arguments = arguments.parse_args()

# %% The curve and the verdict
session = todbench_session.read_session(arguments.session)
print("verdict:", session.verdict["decision"], "-", session.verdict["reason"])
for side in np.unique(session.curve["side"]):
    points = session.of_side(side)
    for contrast, size, low, high in zip(points["set_delta_t_k"], points["s75_mrad"], points["s75_ci95_low_mrad"],
                                         points["s75_ci95_high_mrad"]):
        print(f"{side:10s} {contrast:8.3f} K  S75 {size:.4f} mrad  95 % {low:.4f} to {high:.4f}")

# %% Share of right answers by size, at the highest contrast
trials = session.trials
highest = trials["set_delta_t_k"] == np.max(trials["set_delta_t_k"])
right = trials["truth"] == trials["answer"]
counts = [(size, int(np.sum(right[highest & (trials["size_mrad"] == size)])), int(np.sum(highest & (trials["size_mrad"] == size))))
          for size in np.unique(trials["size_mrad"][highest])]
for size, correct, total in counts:
    print(f"{size:8.4f} mrad  {correct:4d} of {total}")

# %% The same, fitted by the program
if arguments.fit:
    with tempfile.NamedTemporaryFile("w", suffix=".csv", newline="") as file:
        csv.writer(file).writerows([("size", "correct", "total"), *counts])
        file.flush()
        fit = todbench_session.run_json("fit", file.name, program=arguments.fit)
    print("fit:", fit["verdict"], fit["threshold"], fit["ci95"])

# %% A recording: temperatures, and the noise of a pixel from successive frames
if arguments.recording:
    frames = [frame for frame in todbench_session.read_recording(arguments.recording) if frame.complete]
    print(f"{len(frames)} complete frames of {frames[0].camera['id']}, {frames[0].counts.shape[1]} x {frames[0].counts.shape[0]}")
    unit, values = ("counts", lambda frame: frame.counts.astype(float))
    if frames[0].camera["scale"]["kind"] != "uncalibrated":
        unit, values = ("K", lambda frame: frame.kelvin())
    print(f"mean {np.mean(values(frames[0])):.3f} {unit}")
    # The median over pairs, because between two of them the target may have moved; within one the mean size of the
    # differences, sd 2 / sqrt(pi) of normal noise, because a median of whole counts would be a whole count.
    noise = [np.mean(np.abs(values(b) - values(a))) * np.sqrt(np.pi) / 2 for a, b in zip(frames, frames[1:])]
    if noise:
        print(f"temporal noise {np.median(noise):.4f} {unit}")

# %% A figure, without a library of plots
if arguments.svg:
    sides = {side: session.of_side(side) for side in np.unique(session.curve["side"])}
    x_all = np.log10(np.abs(session.curve["set_delta_t_k"]))
    y_all = session.curve["acuity_per_mrad"]
    x_of = lambda x: 60 + 400 * (x - x_all.min() + 0.1) / (np.ptp(x_all) + 0.2)
    y_of = lambda y: 260 - 220 * y / np.nanmax(y_all) / 1.1
    parts = ['<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 500 310" font-family="sans-serif" font-size="11">',
             '<rect width="500" height="310" fill="#ffffff"/>',
             '<path d="M60 30V260H470" fill="none" stroke="#444444"/>',
             '<text x="60" y="20">75 % acuity [1/mrad] over contrast [K]</text>']
    for (side, points), colour in zip(sorted(sides.items()), ("#1f77b4", "#d95f02")):
        for contrast, acuity, low, high in zip(points["set_delta_t_k"], points["acuity_per_mrad"],
                                               points["acuity_ci95_low_per_mrad"], points["acuity_ci95_high_per_mrad"]):
            if np.isnan([acuity, low, high]).any():
                continue
            x = x_of(np.log10(abs(contrast))) + (4 if side == "simulated" else -4)
            parts.append(f'<path d="M{x:.1f} {y_of(low):.1f}V{y_of(high):.1f}" stroke="{colour}"/>'
                         f'<circle cx="{x:.1f}" cy="{y_of(acuity):.1f}" r="3" fill="{colour}"><title>{side} {acuity:.4f}</title></circle>'
                         f'<text x="{x:.1f}" y="275" text-anchor="middle">{contrast:g}</text>')
        parts.append(f'<text x="70" y="{40 + 14 * list(sides).index(side)}" fill="{colour}">{side}</text>')
    with open(arguments.svg, "w", encoding="utf-8") as file:
        file.write("\n".join([*parts, "</svg>"]))
