// SPDX-License-Identifier: GPL-3.0-or-later
// Examples of every command, for its help and its manual page. A test parses each of them and runs those that need
// neither a device nor minutes.
#include <array>

#include "bench/cli/command_line.h"

namespace todbench {
namespace {

struct ExampleRow {
  std::string_view command, line, effect;
};

constexpr std::array example_rows{
    ExampleRow{"demo", "todbench demo --out first", "runs the whole test without hardware"},
    ExampleRow{"devices", "todbench devices", "lists the ids for [camera] id of a plan"},
    ExampleRow{"doctor", "todbench doctor --frame-bytes 614400 --frame-rate-hz 50",
               "checks the computer for a camera of 640 x 480 pixels at 50 Hz"},
    ExampleRow{"emulate", "todbench emulate --camera gige", "offers a camera to the plan of another terminal"},
    ExampleRow{"measure", "todbench measure acceptance --out unit-1 --record-frames",
               "measures by the shipped plan 'acceptance' and stores the frames"},
    ExampleRow{"measure", "todbench measure --resume unit-1 --out unit-1-resumed",
               "goes on with an interrupted session that recorded its frames"},
    ExampleRow{"record", "todbench record sim:sc2000 --frames 100 --out noise.todrec",
               "records 100 frames of the simulated camera"},
    ExampleRow{"replay", "todbench replay unit-1 --out unit-1-again", "needs a session with recorded frames"},
    ExampleRow{"judge", "todbench judge unit-1 --observer hvs-2 --display my-display.toml --out unit-1-hvs-2",
               "judges recorded frames by an observer with an eye"},
    ExampleRow{"blind", "todbench blind unit-1 --packages sharp.toml --simulated --simulated-person --out unit-1-blind",
               "judges camera, twin and enhanced frames in one mixed order"},
    ExampleRow{"serve", "todbench serve --address 127.0.0.1:8800 --sessions runs",
               "starts and shows runs in a browser"},
    ExampleRow{"watch", "todbench watch sim:sc2000 --minutes 30 --json", "follows the warm-up of a camera"},
    ExampleRow{"simulate", "todbench simulate demo --accuracy draft --out curve", "simulates the plan 'demo' quickly"},
    ExampleRow{"plan", "todbench plan demo", "predicts trials, uncertainty and time"},
    ExampleRow{"plan", "todbench plan demo --optimise --half-width 2.5 --out faster.toml",
               "writes the plan that needs the least bench time for 2.5 %"},
    ExampleRow{"cost", "todbench cost demo --budget-s 20", "measures for at most 20 s"},
    ExampleRow{"render", "todbench render --sensor sc2000 --size-pitch 3 --apex up",
               "prints the picture of a triangle of 3 pixels in kelvin"},
    ExampleRow{"mtf", "todbench mtf --sensor sc2000 --frequency-per-pitch 0.1,0.25,0.5",
               "tabulates the MTF up to the Nyquist frequency"},
    ExampleRow{"plate", "todbench plate tcat-a --dxf tcat-a.dxf --pdf tcat-a.pdf",
               "writes the drawings for the workshop"},
    ExampleRow{"compare", "todbench compare unit-1 unit-2 --svg curves.svg",
               "compares two units and draws both curves"},
    ExampleRow{"report", "todbench report curve", "writes report.html and report.csv of the session again"},
    ExampleRow{"verify", "todbench verify curve", "names every file that was changed after the run"},
    ExampleRow{"sign", "todbench sign unit-1 --with openssl --key laboratory.pem",
               "signs with the key of the laboratory"},
    ExampleRow{"certificate", "todbench certificate curve --order order.toml --dcc curve.xml",
               "writes the results as a digital calibration certificate"},
    ExampleRow{"conformity", "todbench conformity --value 0.48 --u 0.01 --at-least 0.45",
               "judges a measured acuity of 0.48 per mrad"},
    ExampleRow{"budget", "todbench budget budget.toml", "combines the rows of the file"},
    ExampleRow{"fit", "todbench fit docs/examples/trials.csv --form acuity", "fits counts of correct answers"},
    ExampleRow{"noise", "todbench noise noise.todrec --components-only", "prints the seven components of 3-D noise"},
    ExampleRow{"sfr", "todbench sfr edge.tiff --pitch-mrad 1.31", "measures the MTF per mrad"},
    ExampleRow{"sitf", "todbench sitf steps.csv", "fits a line to the temperature steps"},
    ExampleRow{"mrtd", "todbench mrtd --sensor sc2000 --of-nyquist 0.2,0.4,0.6",
               "predicts the MRTD at three frequencies"},
    ExampleRow{"dynamic", "todbench dynamic --sensor sc2000 --speeds-mrad-s 10 30",
               "simulates a target at 10 and 30 mrad/s"},
    ExampleRow{"pattern", "todbench pattern edge --pixels 640 480 --format tiff --out edge.tiff",
               "draws a slanted edge and its true values"},
    ExampleRow{"range", "todbench range --tod curve --size-m 2.3 --delta-t-k 4 --extinction-per-km 0.2",
               "predicts the range at which a vehicle is identified"},
    ExampleRow{"identify", "todbench identify small-craft --sensor sc2000 --ranges 200,400,600",
               "predicts correct answers at three ranges"},
    ExampleRow{"picture",
               "todbench picture craft-at-sea --sensor sc2000 --range-m 400 --atmosphere us-standard --out craft",
               "writes the picture after each stage"},
    ExampleRow{"sweep", "todbench sweep run sweep.toml --jobs 4", "runs four tasks at a time"},
    ExampleRow{"sweep expand", "todbench sweep expand sweep.toml", "counts the tasks"},
    ExampleRow{"sweep run", "todbench sweep run sweep.toml --jobs 4", "runs four tasks at a time"},
    ExampleRow{"sweep status", "todbench sweep status sweep.toml", "counts what is done"},
    ExampleRow{"sweep tasks", "todbench sweep tasks sweep.toml --for slurm --chunk 20",
               "prints a job array with 20 tasks in a job"},
    ExampleRow{"sweep submit", "todbench sweep submit sweep.toml --engine local --jobs 2", "runs the tasks here"},
    ExampleRow{"sweep collect", "todbench sweep collect sweep.toml --page effects.html", "writes table and page"},
    ExampleRow{"enhance", "todbench enhance demo --packages docs/examples/packages/sharpen.toml",
               "compares sharpened with plain frames"},
    ExampleRow{"compare-models", "todbench compare-models hvs-1 human-like-1 --plan demo", "compares two observers"},
    ExampleRow{"scene-dependence", "todbench scene-dependence demo", "measures the effect of a hot bar"},
    ExampleRow{"observer", "todbench observer sensitivity hvs-2 --luminance 50 --frequency 1,4,16",
               "prints the contrast sensitivity of an eye"},
    ExampleRow{"observer sensitivity", "todbench observer sensitivity hvs-2 --luminance 50 --frequency 1,4,16",
               "prints the contrast sensitivity of an eye"},
    ExampleRow{"observer naked-eye", "todbench observer naked-eye my-display.toml --out naked --person hvs-2",
               "predicts a session without a camera and simulates a person"},
    ExampleRow{"observer fit", "todbench observer fit unit-1 --from hvs-1 --free internal_noise --out person.toml",
               "fits the noise of an observer to the answers of a person"},
    ExampleRow{"reference-set", "todbench reference-set --out reference", "writes frames with known thresholds"},
    ExampleRow{"round-robin", "todbench round-robin evaluate results.csv --out comparison",
               "compares the results of laboratories"},
    ExampleRow{"round-robin prepare", "todbench round-robin prepare --out comparison --laboratories 8",
               "writes a folder for each laboratory and a sealed file"},
    ExampleRow{"round-robin judge",
               "todbench round-robin judge comparison/laboratory-1 --laboratory A --out results-1.csv",
               "judges the recordings of one laboratory"},
    ExampleRow{"round-robin evaluate",
               "todbench round-robin evaluate results.csv --sealed sealed.json --out comparison",
               "also compares the reference values with the sealed truth"},
    ExampleRow{"reproduce", "todbench reproduce eo-vista", "writes a page beside the published figures"},
    ExampleRow{"selftest", "todbench selftest --all", "lists every case"},
    ExampleRow{"history", "todbench history add unit-1 unit-2", "adds two sessions"},
    ExampleRow{"history add", "todbench history add unit-1 unit-2", "adds two sessions"},
    ExampleRow{"history show", "todbench history show TB-0001 --measure acuity --at-least 0.4",
               "draws the control chart of the acuity"},
    ExampleRow{"history check", "todbench history check --horizon-days 180", "exit code 3 for an alarm"},
    ExampleRow{"history prior", "todbench history prior SC2000 --without TB-0001 --out fleet.toml",
               "describes the other units as rows of a plan"},
    ExampleRow{"history export", "todbench history export --out history.csv", "writes every value"},
    ExampleRow{"history event", "todbench history event TB-0001 --kind repair --text \"new shutter\"",
               "begins the charts of the unit anew"},
    ExampleRow{"instrument", "todbench instrument check scpi-black-body 127.0.0.1:5025", "tests each query"},
    ExampleRow{"instrument check", "todbench instrument check scpi-black-body 127.0.0.1:5025", "tests each query"},
    ExampleRow{"module", "todbench module check \"python3 docs/examples/modules/sharpen.py\"",
               "tests the contract of a module"},
    ExampleRow{"module check", "todbench module check \"python3 docs/examples/modules/sharpen.py\"",
               "tests the contract of a module"},
};

void add_examples_to(CLI::App& command, const std::string& name, const std::string& footer) {
  std::string text;
  for (const CommandExample& example : examples_of(name)) text += "\n  " + example.line + "\n      " + example.effect;
  if (!text.empty()) command.footer("Example:" + text + "\n\n" + footer);
  for (CLI::App* below : command.get_subcommands({})) add_examples_to(*below, name + " " + below->get_name(), footer);
}

}  // namespace

std::vector<CommandExample> examples_of(std::string_view command) {
  std::vector<CommandExample> examples;
  for (const ExampleRow& row : example_rows) {
    if (row.command == command) examples.push_back({std::string(row.line), std::string(row.effect)});
  }
  return examples;
}

void add_examples(CLI::App& app) {
  for (CLI::App* command : app.get_subcommands({})) add_examples_to(*command, command->get_name(), app.get_footer());
}

}  // namespace todbench
