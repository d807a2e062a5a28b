# SPDX-License-Identifier: GPL-3.0-or-later
"""python_examples_test.py PROGRAM SOURCE: the Python reader of docs/examples against what the program writes. Exit code 77: skipped."""
import json
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

PROGRAM, SOURCE = sys.argv[1], Path(sys.argv[2])
EXAMPLES = SOURCE / "docs" / "examples"
try:
    import numpy as np
except ImportError:
    print("skipped: python3-numpy is not installed")
    sys.exit(77)
sys.path.insert(0, str(EXAMPLES))
import todbench_session


def run(*arguments):
    return subprocess.run(arguments, capture_output=True, text=True, check=False)


class Examples(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = Path(tempfile.mkdtemp())
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        cls.session = cls.folder / "session"
        ended = run(PROGRAM, "simulate", "--delta-t-k", "16.9,1.93", "--accuracy", "draft", "--out", cls.session, "--json", "--quiet")
        assert ended.returncode in (0, 1, 3), ended.stderr
        cls.json = json.loads(ended.stdout)
        cls.raw = SOURCE / "tests/golden/real/lepton_a_160x120_u16le.raw"
        cls.recording = cls.folder / "lepton.todrec"
        camera = f"file:{cls.raw}?width=160&height=120&kelvin_per_count=0.01&offset_k=0"
        ended = run(PROGRAM, "record", camera, "--out", cls.recording, "--quiet")
        assert ended.returncode == 0, ended.stderr

    def test_the_curve_is_that_of_json(self):
        session = todbench_session.read_session(self.session)
        self.assertEqual(session.verdict["decision"], self.json["verdict"])
        np.testing.assert_array_equal(session.curve["s75_mrad"], [point["s75_mrad"] for point in self.json["points"]])
        for point in self.json["points"]:
            self.assertEqual(np.sum(session.trials["set_delta_t_k"] == point["delta_t_k"]), point["trials"])

    def test_the_table_of_the_report_is_that_of_json(self):
        report = todbench_session.read_table(self.session / "report.csv")
        whole = (report["section"] == "verdict") & (report["name"] == "decision")
        self.assertEqual(list(report["decision"][whole]), [self.json["verdict"]])
        for point in self.json["points"]:
            row = (report["name"] == "s75_mrad") & (report["set_delta_t_k"] == point["delta_t_k"])
            self.assertEqual(report["section"][row][0], "simulated")
            np.testing.assert_array_equal(report["value"][row], [point["s75_mrad"]])
            np.testing.assert_array_equal([report["low"][row][0], report["high"][row][0]], point["s75_ci95_mrad"])
        self.assertEqual(run(PROGRAM, "verify", self.session).returncode, 0)

    def test_the_report_is_rebuilt_as_it_was(self):
        rebuilt = self.folder / "rebuilt"
        shutil.copytree(self.session, rebuilt)
        (rebuilt / "report.csv").unlink()
        self.assertEqual(run(PROGRAM, "report", rebuilt).returncode, 0)
        # The name of the folder is the name of the session.
        before, after = ((folder / "report.csv").read_text().splitlines()[2:] for folder in (self.session, rebuilt))
        self.assertEqual(before, after)
        self.assertEqual(run(PROGRAM, "verify", rebuilt).returncode, 0)

    def test_a_changed_session_is_refused(self):
        changed = self.folder / "changed"
        shutil.copytree(self.session, changed)
        text = (changed / "trials.csv").read_text()
        (changed / "trials.csv").write_text(text.replace("up", "down", 1))
        with self.assertRaisesRegex(todbench_session.Refused, "trials.csv"):
            todbench_session.read_session(changed)

    def test_a_recording_is_the_bytes_that_were_recorded(self):
        frames = list(todbench_session.read_recording(self.recording))
        counts = np.fromfile(self.raw, "<u2").reshape(-1, 120, 160)
        np.testing.assert_array_equal(np.stack([frame.counts for frame in frames]), counts)
        self.assertTrue(all(frame.complete for frame in frames))
        np.testing.assert_allclose(frames[0].kelvin(), counts[0] * 0.01)

    def test_a_flipped_bit_makes_a_frame_incomplete(self):
        damaged = self.folder / "damaged.todrec"
        data = bytearray(self.recording.read_bytes())
        data[-1] ^= 1
        damaged.write_bytes(data)
        self.assertEqual([frame.complete for frame in todbench_session.read_recording(damaged)].count(False), 1)

    def test_a_recording_that_was_cut_off_ends_with_its_last_whole_frame(self):
        cut = self.folder / "cut.todrec"
        cut.write_bytes(self.recording.read_bytes()[:-1])
        whole = sum(1 for _ in todbench_session.read_recording(self.recording))
        self.assertEqual(sum(1 for _ in todbench_session.read_recording(cut)), whole - 1)

    def test_scales(self):
        planck = {"kind": "planck", "r": 16000.0, "b": 1430.0, "f": 1.0, "o": 100.0}
        self.assertAlmostEqual(float(todbench_session.kelvin_of(200, planck)), 1430 / np.log(16000 / 100 + 1))
        self.assertTrue(np.isnan(todbench_session.kelvin_of(100, planck)))
        table = {"kind": "table", "counts": [0, 10], "temperature_k": [300, 310]}
        np.testing.assert_array_equal(todbench_session.kelvin_of([5, 11], table), [305, np.nan])

    def test_wrong_use_of_the_program_is_its_sentence(self):
        with self.assertRaisesRegex(todbench_session.Refused, "nowhere.csv"):
            todbench_session.run_json("fit", "nowhere.csv", program=PROGRAM)

    def test_the_script_prints_and_draws(self):
        figure = self.folder / "curve.svg"
        ended = run(sys.executable, EXAMPLES / "look_at_session.py", self.session, self.recording, "--svg", figure, "--fit", PROGRAM)
        self.assertEqual(ended.returncode, 0, ended.stderr)
        self.assertIn("verdict: " + self.json["verdict"], ended.stdout)
        self.assertIn("160 x 120", ended.stdout)
        self.assertIn("fit: ", ended.stdout)
        self.assertEqual(figure.read_text().count("<circle"), 2)

    def test_the_script_prints_the_noise_that_a_recording_has(self):
        raw, recording = self.folder / "noise.raw", self.folder / "noise.todrec"
        # 7 counts of noise: the middle one of their differences is a whole count, 5 % too large for them.
        noise = np.random.default_rng(1).normal(30000, 7, (12, 120, 160))
        np.rint(noise).astype("<u2").tofile(raw)
        camera = f"file:{raw}?width=160&height=120&kelvin_per_count=0.01&offset_k=0"
        self.assertEqual(run(PROGRAM, "record", camera, "--out", recording, "--quiet").returncode, 0)
        ended = run(sys.executable, EXAMPLES / "look_at_session.py", self.session, recording)
        self.assertEqual(ended.returncode, 0, ended.stderr)
        found = float(ended.stdout.split("temporal noise ")[1].split()[0])
        self.assertAlmostEqual(found, 0.07, delta=0.0007)

    def test_the_verdict_is_as_its_schema_says(self):
        try:
            import jsonschema
        except ImportError:
            self.skipTest("python3-jsonschema is not installed")
        schema = json.loads((SOURCE / "docs/verdict.schema.json").read_text())
        jsonschema.Draft202012Validator.check_schema(schema)
        validator = jsonschema.Draft202012Validator(schema)
        verdict = json.loads((self.session / "verdict.json").read_text())
        validator.validate(verdict)
        validator.validate(self.json["judgement"])
        for wrong in ({**verdict, "decision": "maybe"}, {**verdict, "schema": "todbench-verdict-2"},
                      {name: value for name, value in verdict.items() if name != "demands"}):
            self.assertFalse(validator.is_valid(wrong))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
