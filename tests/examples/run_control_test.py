# SPDX-License-Identifier: GPL-3.0-or-later
"""run_control_test.py PROGRAM SOURCE: the client of docs/examples against the program, and a foreign reader of certificates."""
import json
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import unittest
import urllib.error
import xml.etree.ElementTree as ElementTree
from pathlib import Path

PROGRAM, SOURCE = sys.argv[1], Path(sys.argv[2])
sys.path.insert(0, str(SOURCE / "docs" / "examples"))
import run_control_client

BUDGET = """
[uncertainty]
[[uncertainty.component]]
name = "distance"
value = 1
unit = "mm"
distribution = "rectangular"
"""
ORDER = """
[order]
customer = "Ada & <Sons> \\"Ltd\\""
report_number = "TB-2099-001"
laboratory = "Laboratory"
country = "DE"
item = "Camera ]]> no. 1"
received = "2020-01-31"
issued = "2099-01-31"
room_temperature_c = 23.5
authorised_by = "B. Bureau"
"""
NAMES = {"dcc": "https://ptb.de/dcc", "si": "https://ptb.de/si"}


def plan(*more, camera=True):
    lines = 'name = "small"\n[target]\ndistance_m = 2\nplates = ["tcat-a"]\nmountings = ["identity"]\ndelta_t_k = [16.9]\n'
    lines += 'phases = 16\n[fit]\nestimator = "weibull"\n[simulation]\naccuracy = "draft"\nphases = 16\n'
    return lines + ('[camera]\nid = "sim:sc2000"\nifov_mrad = 1.3085399449\n' if camera else "") + "".join(more)


def run(*arguments):
    return subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, check=False)


class RunControl(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = Path(tempfile.mkdtemp())
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        command = [PROGRAM, "serve", "--address", "127.0.0.1:0", "--sessions", cls.folder, "--json"]
        cls.server = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        cls.addClassCleanup(cls.server.wait)
        cls.addClassCleanup(cls.server.stdout.close)
        cls.addClassCleanup(cls.server.terminate)
        cls.said = json.loads(cls.server.stdout.readline())
        cls.bench = run_control_client.Bench(cls.said["url"], cls.said["token"])

    def same_verdict(self, mode):
        text = plan(camera=mode == "measure")
        last = self.bench.run(text, mode=mode, seed=11)
        (self.folder / "plan.toml").write_text(text)
        by_hand = run(mode, self.folder / "plan.toml", "--seed", 11, "--out", self.folder / mode, "--quiet")
        self.assertEqual(last["state"], "finished", last)
        self.assertEqual(last["exit_code"], by_hand.returncode, by_hand.stderr)
        served = self.bench.open(f"runs/{last['id']}/files/verdict.json").read()
        self.assertEqual(served, (self.folder / mode / "verdict.json").read_bytes())
        self.assertEqual(run("verify", last["session"]).returncode, 0)

    def test_the_verdict_of_a_measurement_is_that_of_the_command_line(self):
        self.same_verdict("measure")

    def test_the_verdict_of_a_simulation_is_that_of_the_command_line(self):
        self.same_verdict("simulate")

    def test_a_wrong_plan_and_a_wrong_token_are_told_apart(self):
        self.assertFalse(self.bench.post("plans/check", {"plan_toml": "phases = 1,5"})["valid"])
        self.assertTrue(self.bench.post("plans/check", {"plan_toml": plan()})["valid"])
        with self.assertRaises(urllib.error.HTTPError) as refused:
            run_control_client.Bench(self.said["url"], "0" * 32).get("runs")
        self.assertEqual(refused.exception.code, 401)
        refused.exception.close()


class Certificate(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = Path(tempfile.mkdtemp())
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        (cls.folder / "plan.toml").write_text(plan(BUDGET, "[measures]\nnoise = true\n", ORDER))
        cls.order = cls.folder / "order.toml"
        cls.order.write_text(ORDER)
        cls.session = cls.folder / "session"
        cls.measured = run("measure", cls.folder / "plan.toml", "--out", cls.session, "--json", "--quiet")
        assert cls.measured.returncode in (0, 1, 3), cls.measured.stderr
        cls.point = json.loads(cls.measured.stdout)["points"][0]
        cls.xml = cls.folder / "dcc.xml"
        cls.made = run("certificate", cls.session, "--dcc", cls.xml, "--order", cls.order, "--json")

    def refused(self, sentence, *arguments):
        file = self.folder / "none.xml"
        ended = run("certificate", *arguments, "--dcc", file)
        self.assertEqual(ended.returncode, 2, ended.stderr)
        self.assertEqual(ended.stderr.count("\n"), 1)
        self.assertIn(sentence, ended.stderr)
        self.assertFalse(file.exists())

    def test_a_foreign_reader_reads_it(self):
        self.assertEqual(self.made.returncode, 0, self.made.stderr)
        root = ElementTree.parse(self.xml).getroot()
        self.assertEqual(root.tag, "{https://ptb.de/dcc}digitalCalibrationCertificate")
        text = lambda path: root.find(path, NAMES).text
        self.assertEqual(text(".//dcc:customer/dcc:name/dcc:content"), 'Ada & <Sons> "Ltd"')
        self.assertEqual(text(".//dcc:item/dcc:name/dcc:content"), "Camera ]]> no. 1")
        self.assertEqual(text(".//dcc:uniqueIdentifier"), "TB-2099-001")
        self.assertEqual(text(".//dcc:influenceCondition//si:value"), "23.5")
        self.assertNotIn("nan", self.xml.read_text().lower().replace("nance", ""))

    def test_its_numbers_are_those_of_json(self):
        root = ElementTree.parse(self.xml).getroot()
        quantities = {q.find("dcc:name/dcc:content", NAMES).text: q.find("si:real", NAMES)
                      for q in root.findall(".//dcc:result//dcc:quantity", NAMES)}
        size = quantities["S75, triangle size at 75 % correct"]
        value = float(size.find("si:value", NAMES).text)
        self.assertEqual(value, self.point["s75_mrad"])
        low, high = self.point["s75_expanded95_mrad"]
        uncertainty = float(size.find("si:expandedUnc/si:uncertainty", NAMES).text)
        self.assertAlmostEqual(uncertainty, max(value - low, high - value), 12)
        self.assertGreater(float(size.find("si:expandedUnc/si:coverageFactor", NAMES).text), 1.9)
        acuity = quantities["75 % acuity"]
        self.assertAlmostEqual(float(acuity.find("si:value", NAMES).text), 1 / value, 12)

    def test_the_order_of_the_plan_makes_the_same_certificate(self):
        other = self.folder / "of-the-plan.xml"
        made = run("certificate", self.session, "--dcc", other)
        self.assertEqual(made.returncode, 0, made.stderr)
        self.assertEqual(other.read_bytes(), self.xml.read_bytes())

    def test_every_result_with_an_uncertainty_was_measured(self):
        root = ElementTree.parse(self.xml).getroot()
        found = root.findall(".//dcc:result//si:expandedUnc/si:uncertainty", NAMES)
        self.assertGreater(len(found), 3)
        for uncertainty in found:
            self.assertGreater(float(uncertainty.text), 0, "a value of the plan or of the sensor model")

    def test_it_contains_the_physical_measures_with_their_intervals(self):
        lines = json.loads((self.session / "measures.json").read_text())["main"]["quantities"]
        noise = next(line for line in lines if line["measure"] == "temporal_noise")
        root = ElementTree.parse(self.xml).getroot()
        found = [q.find("si:real", NAMES) for q in root.findall(".//dcc:result//dcc:quantity", NAMES)
                 if q.find("dcc:name/dcc:content", NAMES).text == "temporal_noise"]
        self.assertEqual(len(found), 1)
        value, unit = (found[0].find(f"si:{key}", NAMES).text for key in ("value", "unit"))
        self.assertEqual((float(value), unit), (noise["value"], "\\kelvin"))
        low, high = noise.get("expanded_ci95") or noise["ci95"]
        uncertainty = float(found[0].find("si:expandedUnc/si:uncertainty", NAMES).text)
        self.assertAlmostEqual(uncertainty, max(noise["value"] - low, high - noise["value"]), 12)

    def test_a_hostile_certificate_of_an_instrument_is_a_sentence(self):
        hostile = {
            "bomb.xml": b'<!DOCTYPE l [<!ENTITY a "haha">' +
                        b"".join(b'<!ENTITY %c "%s">' % (98 + i, b"&%c;" % (97 + i) * 10) for i in range(9)) +
                        b"]><l>&j;</l>",
            "external.xml": b'<!DOCTYPE l [<!ENTITY x SYSTEM "file:///etc/passwd">]><l>&x;</l>',
            "deep.xml": b"<a>" * 1_000_000,
            "huge.xml": None,
        }
        for name, content in hostile.items():
            file = self.folder / name
            with open(file, "wb") as out:
                out.write(content or b"")
                if content is None:
                    out.truncate(1 << 30)  # sparse
            self.folder.joinpath("hostile.toml").write_text(
                plan(f'[[instrument]]\nname = "black body"\ndcc = "{name}"\n'))
            before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss
            ended = run("plan", self.folder / "hostile.toml")
            self.assertEqual(ended.returncode, 2, name + ended.stderr)
            self.assertEqual(ended.stderr.count("\n"), 1, ended.stderr[:500])
            self.assertIn("key 'dcc' in [instrument]", ended.stderr)
            self.assertLess(len(ended.stderr), 600)
            # The largest child so far measured a session; a file of 1 GiB would exceed it.
            self.assertLess(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss, max(before, 400_000))

    def test_xmllint_finds_it_well_formed(self):
        if shutil.which("xmllint") is None:
            self.skipTest("xmllint is not installed")
        self.assertEqual(subprocess.run(["xmllint", "--noout", self.xml], check=False).returncode, 0)

    def test_an_order_without_what_it_needs_is_refused(self):
        order = self.folder / "other.toml"
        order.write_text("[order]\n")
        self.refused("lacks customer, report_number", self.session, "--order", order)
        order.write_text("[order]\ncustomer = \"A\"\n")
        self.refused("lacks report_number, laboratory, country, issued, authorised_by", self.session,
                     "--order", order)
        order.write_text("[order]\ncustommer = \"A\"\n")
        self.refused("custommer", self.session, "--order", order)
        order.write_text(ORDER.replace("2099-01-31", "2001-01-31"))
        self.refused("before the end of the measurement", self.session, "--order", order)

    def test_a_session_without_what_it_needs_is_refused(self):
        (self.folder / "bare.toml").write_text(plan())
        run("measure", self.folder / "bare.toml", "--out", self.folder / "bare", "--quiet")
        self.refused("no uncertainty budget", self.folder / "bare", "--order", self.order)
        run("simulate", self.folder / "plan.toml", "--out", self.folder / "simulated", "--quiet")
        self.refused("no camera was measured", self.folder / "simulated", "--order", self.order)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
