# SPDX-License-Identifier: GPL-3.0-or-later
"""The numbers of the package are those of the command line, bit for bit: JSON keeps every digit of a double."""
import json

import numpy as np
import todbench as tb

TIMES = ("wall_s",)


def without(keys, record):
    return {key: value for key, value in record.items() if key not in keys}


def test_fits_are_equal(program, source):
    file = source / "docs/examples/trials.csv"
    size, correct, total, cluster = tb.read_levels(file)

    for options in ({}, {"form": "acuity"}, {"lapse": 0.02}, {"lapse": None}):
        words = [w for key, value in options.items() for w in (f"--{key}", "free" if value is None else value)]
        _, told = program("fit", file, *words)
        fit = tb.fit_psychometric(size, correct, total, cluster, **options)

        assert {key: told[key] for key in fit.to_dict()} == fit.to_dict()
        assert told["adequacy"] == tb.adequacy(size, correct, total, fit, cluster, **options)


def test_conformity_is_equal(program):
    for more in ({}, {"degrees_of_freedom": 7.0}):
        words = ["--nu", 7] if more else []
        _, told = program("conformity", "--value", 0.472, "--u", 0.013, "--at-least", 0.45, *words)
        found = tb.conformity(0.472, 0.013, at_least=0.45, **more)

        assert told["decision"] == found.decision
        assert told["p_conformity"] == found.p_conformity
        assert told["guard_band"] == found.guard_band
        assert tuple(told["acceptance_limits"]) == found.acceptance_limits


def test_signal_transfer_is_equal(program, tmp_path):
    file = tmp_path / "steps.csv"
    file.write_text("delta_t_k,counts,counts_se\n-4,-395.2,1.1\n-2,-199.7,0.9\n1,101.3,1\n2,200.4,1\n4,401.9,1.2\n")
    _, told = program("sitf", file)
    line = tb.signal_transfer([-4, -2, 1, 2, 4], [-395.2, -199.7, 101.3, 200.4, 401.9], [1.1, 0.9, 1, 1, 1.2])

    for key in ("slope", "slope_u", "offset", "chi2", "p", "nonlinearity_percent", "r_squared"):
        assert told[key] == getattr(line, key)
    assert told["residuals"] == line.residuals.tolist()


def test_slanted_edges_are_equal(program, tmp_path):
    rows, columns = np.mgrid[0:60, 0:80].astype(float)
    sharp = np.clip((columns - 40 - np.tan(np.radians(5)) * (rows - 30)) / 1.5 + 0.5, 0, 1)
    picture = 100 + 50 * sharp + np.random.default_rng(2).normal(0, 0.2, sharp.shape)
    np.save(tmp_path / "edge.npy", picture)
    _, told = program("sfr", tmp_path / "edge.npy")

    edge = tb.slanted_edge(picture)

    assert told["mtf"] == edge.mtf.tolist()
    assert told["angle_deg"] == edge.angle_deg
    assert [high for _, high in told["mtf_ci95"]] == edge.mtf_high.tolist()
    assert (tb.read_picture(tmp_path / "edge.npy") == picture).all()


def test_a_budget_is_equal(program, tmp_path):
    file = tmp_path / "budget.toml"
    file.write_text('quantity = "acuity"\nunit = "%"\n'
                    '[[component]]\nname = "distance"\nvalue = 0.4\nunit = "%"\n'
                    '[[component]]\nname = "scale"\nvalue = 0.9\nunit = "%"\ndistribution = "rectangular"\n'
                    '[[component]]\nname = "trials"\nvalue = 1.1\nunit = "%"\ndegrees_of_freedom = 9\n')
    _, told = program("budget", file, "--seed", 4)

    found = tb.read_budget(file).combined(seed=4)

    for key in ("u", "nu_eff", "k", "expanded_gum", "expanded_monte_carlo", "expanded"):
        assert told[key] == getattr(found, key)


def test_a_simulation_is_equal(program, small_plan, small_outcome, tmp_path):
    small_plan.write(tmp_path / "small.toml")
    _, told = program("simulate", tmp_path / "small.toml", "--out", tmp_path / "cli")

    mine = small_outcome.to_dict()

    assert without(TIMES, {key: told[key] for key in mine}) == without(TIMES, mine)
    for file in ("trials.csv", "curve.csv", "fits.json", "verdict.json"):
        assert (tmp_path / "cli" / file).read_bytes() == (small_outcome.folder / file).read_bytes()


def test_a_session_reads_back_and_compares(program, small_outcome, small_plan, tmp_path):
    other = tb.simulate(small_plan.replaced({"seed": 4}), tmp_path / "other")
    _, told = program("compare", small_outcome.folder, other.folder)

    a, b = tb.open_session(small_outcome.folder), tb.open_session(other.folder)

    assert tb.compare_sessions(a, b).to_dict() == told
    assert a.curve.to_dict() == small_outcome.curve.to_dict()
    assert a.complete and a.verdict == small_outcome.verdict
    assert a.judgement == json.loads(json.dumps(small_outcome.judgement))
    refitted = tb.tod_curve(tb.read_trials(small_outcome.folder / "trials.csv"))
    assert [point.set_delta_t_k for point in refitted.points] == [point.set_delta_t_k for point in a.curve.points]


def test_noise_components_are_equal(program, tmp_path):
    rng = np.random.default_rng(6)
    frames = np.round(7000 + rng.normal(0, 8, (40, 60, 80)) + rng.normal(0, 3, (1, 60, 80)) + rng.normal(0, 2, (40, 60, 1)))
    frames.astype("<u2").tofile(tmp_path / "noise.raw")
    _, told = program("noise", f"file:{tmp_path / 'noise.raw'}?width=80&height=60", "--components-only")

    found = tb.noise_components(frames)

    assert told["variances"] == {name: one.variance for name, one in found.items()}
    assert told["intervals"] == {name: list(one.ci95) for name, one in found.items()}
