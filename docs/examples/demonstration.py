# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of `todbench demo`: the emulated camera against its simulated twin. demonstration.py FOLDER"""
import sys

import todbench as tb


def main(folder):
    plan = tb.demonstration_plan()
    laboratory = tb.Laboratory(plan)
    run = tb.measure(laboratory.plan(plan), folder, on_phase=lambda phase: print(phase, file=sys.stderr))
    if run.ended_by:
        sys.exit(f"ended early: {run.ended_by}")
    print("dT [K]  measured [1/mrad]  95 %            simulated  ratio  verdict")
    for point in run.comparison.points:
        measured, twin = (next(one.fit for one in curve.points if one.set_delta_t_k == point.set_delta_t_k)
                          for curve in (run.curve, run.twin))
        low, high = measured.acuity_ci95
        print(f"{point.delta_t_a_k:6.3f}  {measured.acuity_per_mrad:17.4f}  {low:.4f} … {high:.4f}"
              f"  {twin.acuity_per_mrad:9.4f}  {point.ratio:5.3f}  {point.verdict}")
    print("verdict:", run.verdict)
    return run


if __name__ == "__main__":
    main(sys.argv[1])
