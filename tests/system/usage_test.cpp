// SPDX-License-Identifier: GPL-3.0-or-later
// Wrong use and wrong files: one sentence on standard error, exit code 2, nothing begun.
#include <fstream>

#include "tests/system/system_test_support.h"

namespace todbench::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

struct Misuse {
  const char* name;
  std::vector<std::string> arguments;
  const char* sentence;
};

std::ostream& operator<<(std::ostream& stream, const Misuse& misuse) {
  return stream << misuse.name;
}

class WrongCommandLine : public ::testing::TestWithParam<Misuse> {};

TEST_P(WrongCommandLine, IsOneSentenceAndBeginsNothing) {
  const TemporaryFolder folder;

  const Ended ended = todbench(GetParam().arguments, {.folder = folder.path()});

  expect_refused(ended, 2, GetParam().sentence);
  EXPECT_THAT(lines_of(ended.err), SizeIs(1)) << ended.err;
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(Usage, WithoutACommandThreeThingsToTryAreCommandsThatThereAre) {
  const Ended nothing = todbench({}, {});

  EXPECT_EQ(nothing.code, 2);
  EXPECT_EQ(nothing.out, "");
  int tried = 0;
  for (const std::string& line : lines_of(nothing.err)) {
    if (!line.starts_with("  todbench ")) continue;
    const std::string command = line.substr(11, line.find(' ', 11) - 11);
    EXPECT_EQ(todbench({command, "--help"}, {}).code, 0) << command;
    ++tried;
  }
  EXPECT_EQ(tried, 3);
}

INSTANTIATE_TEST_SUITE_P(
    All, WrongCommandLine,
    ::testing::Values(
        Misuse{"unknown_command", {"simulat"}, "unknown command 'simulat', did you mean 'simulate'?"},
        Misuse{"unknown_option", {"simulate", "--frce"}, "simulate: unknown option --frce, did you mean '--force'?"},
        Misuse{"control_characters", {"simulate", "--x\n\033[31m"}, "simulate: unknown option --x"},
        Misuse{"missing_argument", {"fit"}, "fit: TRIALS.csv is required"},
        Misuse{"missing_option", {"mtf", "--sensor", "sc2000"}, "mtf: --frequency-per-pitch is required"},
        Misuse{"measure_of_no_unit", {"history", "show", "--measure", "netd"}, "--measure requires SERIAL"},
        Misuse{"unknown_plan", {"simulate", "dmeo"}, "unknown plan 'dmeo', did you mean 'demo'?"},
        Misuse{"empty_plan_name", {"measure", ""}, "unknown plan ''"},
        Misuse{"no_such_plan", {"measure", "none/plan.toml"}, "none/plan.toml: no such file"},
        Misuse{"folder_as_plan", {"simulate", "/"}, "/: is a folder, expected a file"},
        Misuse{"device_as_plan", {"simulate", "/dev/null/x.toml"}, "/dev/null/x.toml: no such file"},
        Misuse{"zero_contrast",
               {"simulate", "--delta-t-k", "16.9,0"},
               "--delta-t-k: a contrast of 0 K makes the triangles invisible"},
        Misuse{"contrast_nan", {"simulate", "--delta-t-k", "nan"}, "--delta-t-k: expected a number from -500 to 500"},
        Misuse{"contrast_huge", {"simulate", "--delta-t-k", "1e300"}, "--delta-t-k: expected a number from -500"},
        Misuse{
            "contrast_no_number", {"simulate", "--delta-t-k", "1,x"}, "expected a number from -500 to 500, found 'x'"},
        Misuse{"contrast_empty", {"simulate", "--delta-t-k", ""}, "expected a number from -500 to 500, found ''"},
        Misuse{"contrast_twice", {"simulate", "--delta-t-k", "1,1"}, "--delta-t-k: 1 K is listed twice"},
        Misuse{"seed_negative", {"simulate", "--seed", "-1"}, "--seed: expected a whole number from 0 to"},
        Misuse{"seed_fractional", {"simulate", "--seed", "1.5"}, "--seed: expected a whole number from 0 to"},
        Misuse{"seed_too_big", {"simulate", "--seed", "18446744073709551615"}, "--seed: expected a whole number"},
        Misuse{
            "microscan", {"simulate", "--microscan", "5"}, "--microscan: expected a whole number from 1 to 4, found"},
        Misuse{
            "tolerance", {"simulate", "--tolerance-percent", "nan"}, "expected a number above 0 up to 50, found 'nan'"},
        Misuse{"accuracy", {"simulate", "--accuracy", "nromal"}, "--accuracy: expected one of 'draft', 'normal'"},
        Misuse{"sensor", {"simulate", "--sensor", "sc200"}, "--sensor: unknown sensor 'sc200', did you mean 'sc2000'?"},
        Misuse{"observer", {"simulate", "--observer", "hvs1"}, "--observer: unknown observer 'hvs1', did you mean"},
        Misuse{"observer_empty", {"simulate", "--observer", ""}, "--observer: unknown observer ''"},
        Misuse{"skip", {"simulate", "--skip", "difraction"}, "--skip: unknown effect 'difraction', did you mean"},
        Misuse{"force", {"simulate", "--force", "aberation"}, "--force: unknown effect 'aberation', did you mean"},
        Misuse{"skip_and_force",
               {"simulate", "--skip", "detector", "--force", "detector"},
               "--force: 'detector' is also in skip"},
        Misuse{"out_on_a_device", {"simulate", "--out", "/dev/full"}, "/dev/full: expected a folder, found a file"},
        Misuse{"out_below_a_file", {"simulate", "--out", "/dev/null/x"}, "/dev/null/x: cannot be created"},
        Misuse{"compare_no_session", {"compare", "a", "b"}, "a: not a session folder (there is no session.toml)"},
        Misuse{"compare_margin", {"compare", "a", "b", "--margin-percent", "nan"}, "expected a number from 0.1 to 100"},
        Misuse{"report_no_session", {"report", "."}, ".: not a session folder"},
        Misuse{
            "fit_lapse", {"fit", "x.csv", "--lapse", "0.5"}, "--lapse 0.5: expected a number from 0 to 0.1, or free"},
        Misuse{"fit_form", {"fit", "x.csv", "--form", "log"}, "fit: --form: log not in {size,acuity}"},
        Misuse{
            "mtf_negative", {"mtf", "--sensor", "sc2000", "--frequency-per-pitch", "-1"}, "expected a number from 0"},
        Misuse{"emulate_address", {"emulate", "--interface", "nonsense"}, "emulate: --interface: Invalid IPV4 address"},
        Misuse{"emulate_distance", {"emulate", "--distance-m", "nan"}, "--distance-m: expected a number from 0.1 to"},
        Misuse{"emulate_port", {"emulate", "--stage-port", "70000"}, "--stage-port: expected a whole number from 0 to"},
        Misuse{"mtf_nan", {"mtf", "--sensor", "sc2000", "--frequency-per-pitch", "nan"}, "expected a number from 0"},
        Misuse{"render_nan", {"render", "--sensor", "sc2000", "--size-pitch", "nan"}, "expected a number from 0.01"},
        Misuse{"render_zero", {"render", "--sensor", "sc2000", "--size-pitch", "0"}, "expected a number from 0.01"},
        Misuse{"render_apex",
               {"render", "--sensor", "sc2000", "--size-pitch", "3", "--apex", "north"},
               "--apex: north not in {up,right,down,left}"},
        Misuse{"render_window",
               {"render", "--sensor", "sc2000", "--size-pitch", "3", "--window", "100000"},
               "--window: expected a whole number from 1 to 1024"},
        Misuse{"render_below_a_file",
               {"render", "--sensor", "sc2000", "--size-pitch", "3", "--tiff", "/dev/null/x.tiff"},
               "--tiff /dev/null/x.tiff: /dev/null is not a folder"}),
    [](const auto& row) { return std::string(row.param.name); });

struct BrokenFile {
  const char* name;
  std::vector<std::string> command;  ///< "FILE" is the file
  const char* file;
  std::string content;
  const char* sentence;
};

std::ostream& operator<<(std::ostream& stream, const BrokenFile& broken) {
  return stream << broken.name;
}

class WrongFile : public ::testing::TestWithParam<BrokenFile> {};

TEST_P(WrongFile, IsOneSentenceWithFileAndLine) {
  const TemporaryFolder folder;
  const auto file = folder.write(GetParam().file, GetParam().content);
  std::vector<std::string> command = GetParam().command;
  for (auto& word : command) word = word == "FILE" ? std::string("./") + GetParam().file : word;

  const Ended ended = todbench(command, {.folder = folder.path()});

  expect_refused(ended, 2, GetParam().sentence);
  EXPECT_THAT(lines_of(ended.err), SizeIs(1)) << ended.err;
  EXPECT_THAT(ended.err, HasSubstr(GetParam().file));
}

const std::string binary{
    "\x7f"
    "ELF\0\1\2\xff\xfe\n\0\0",
    12};
const std::string target = "[target]\ndistance_m = 2\n";

INSTANTIATE_TEST_SUITE_P(
    All, WrongFile,
    ::testing::Values(
        BrokenFile{"binary_plan", {"simulate", "FILE"}, "plan.toml", binary, "plan.toml:1: not valid TOML"},
        BrokenFile{"cut_off_plan", {"measure", "FILE"}, "plan.toml", "[target\n", "plan.toml:1: not valid TOML"},
        BrokenFile{"unknown_key",
                   {"simulate", "FILE"},
                   "plan.toml",
                   target + "phasse = 3\n",
                   "plan.toml:3: unknown key 'phasse' in [target], did you mean 'phases'?"},
        BrokenFile{"no_phases",
                   {"simulate", "FILE"},
                   "plan.toml",
                   target + "phases = 0\n",
                   "plan.toml:3: key 'phases' in [target]: expected a whole number from 1"},
        BrokenFile{"distance_negative",
                   {"simulate", "FILE"},
                   "plan.toml",
                   "[target]\ndistance_m = -2\n",
                   "plan.toml:2: key 'distance_m' in [target]: expected a number from 0.01 to 10000, found -2"},
        BrokenFile{"distance_nan",
                   {"simulate", "FILE"},
                   "plan.toml",
                   "[target]\ndistance_m = nan\n",
                   "plan.toml:2: key 'distance_m' in [target]: expected a number from 0.01 to 10000, found nan"},
        BrokenFile{"distance_text",
                   {"simulate", "FILE"},
                   "plan.toml",
                   "[target]\ndistance_m = \"2 m\"\n",
                   "plan.toml:2: key 'distance_m' in [target]: expected a number from 0.01 to 10000, found \"2 m\""},
        BrokenFile{"too_far",
                   {"simulate", "FILE"},
                   "far.toml",
                   small_plan(4, "[[limits.acuity]]\ndelta_t_k = 5\nleast_acuity_per_mrad = 1\n"),
                   "5 K is not among the contrasts of [target]"},
        BrokenFile{"no_camera", {"measure", "FILE"}, "plan.toml", target, "plan.toml: the plan names no camera"},
        BrokenFile{"missing_plate",
                   {"simulate", "FILE"},
                   "plan.toml",
                   target + "plates = [\"./none.toml\"]\n",
                   "plan.toml:3: key 'plates' in [target]"},
        BrokenFile{"folder_as_plate",
                   {"simulate", "FILE"},
                   "plan.toml",
                   target + "plates = [\"./\"]\n",
                   "plan.toml:3: key 'plates' in [target]"},
        BrokenFile{"missing_sensor",
                   {"simulate", "FILE"},
                   "plan.toml",
                   "[simulation]\nsensor = \"./none.toml\"\n",
                   "plan.toml:2: key 'sensor' in [simulation]"},
        BrokenFile{"empty_sensor", {"simulate", "--sensor", "FILE"}, "sensor.toml", "", "sensor.toml:1: missing key"},
        BrokenFile{"binary_sensor",
                   {"mtf", "--frequency-per-pitch", "0", "--sensor", "FILE"},
                   "sensor.toml",
                   binary,
                   "sensor.toml:1: not valid TOML"},
        BrokenFile{"empty_observer", {"simulate", "--observer", "FILE"}, "eye.toml", "", "eye.toml:1: missing key"},
        BrokenFile{"empty_csv", {"fit", "FILE"}, "trials.csv", "", "trials.csv:1: the file is empty"},
        BrokenFile{"binary_csv", {"fit", "FILE"}, "trials.csv", binary, "trials.csv:1:"},
        BrokenFile{"csv_without_column", {"fit", "FILE"}, "trials.csv", "size,correct\n1,2\n", "trials.csv:1: "},
        BrokenFile{"csv_unequal", {"fit", "FILE"}, "trials.csv", "size,correct,total\n1,2\n", "trials.csv:2: "},
        BrokenFile{"csv_negative", {"fit", "FILE"}, "trials.csv", "size,correct,total\n1,-2,5\n", "trials.csv:2: "},
        BrokenFile{"csv_nan", {"fit", "FILE"}, "trials.csv", "size,correct,total\nnan,2,5\n", "trials.csv:2: "},
        BrokenFile{"csv_too_many", {"fit", "FILE"}, "trials.csv", "size,correct,total\n1,6,5\n", "trials.csv:2: "},
        BrokenFile{"csv_fraction", {"fit", "FILE"}, "trials.csv", "size,correct,total\n1,0.5,5\n", "trials.csv:2: "}),
    [](const auto& row) { return std::string(row.param.name); });

TEST(WrongGeometry, SizesThatDoNotFitAreNamed) {
  const TemporaryFolder folder;
  // At 0.5 m the plate of 200 x 280 mm is 306 x 428 pixels of 1.31 mrad, in a picture of 320 x 240.
  folder.write("plan.toml", "[target]\ndistance_m = 0.5\nplates = [\"tcat-a\"]\nphases = 1\n");

  const Ended ended = todbench({"simulate", "./plan.toml", "--out", "session"}, {.folder = folder.path()});

  expect_refused(ended, 2, "not measurable at 0.5 m ([target] distance_m): ");
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "session"));
  EXPECT_THAT(ended.err, HasSubstr("plate tcat-a: its 200 x 280 mm cover 306 x 428 pixels at 0.50 m"));
}

TEST(WrongTarget, ASimulatedCameraSeesNoMonitor) {
  const TemporaryFolder folder;
  folder.write("plan.toml",
               "[camera]\nid = \"sim:sc2000\"\nifov_mrad = 1.3085\n[target]\nkind = \"display\"\ndistance_m = "
               "2\ndisplay_pixel_mm = 0.3\n"
               "display_span_k = 20\n");

  expect_refused(todbench({"measure", "./plan.toml", "--out", "session"}, {.folder = folder.path()}), 2,
                 "camera sim:sc2000 is simulated and cannot observe a monitor");
}

TEST(WrongGeometry, APlateThatIsNotThereIsACalibrationErrorBeforeAnyTrial) {
  const TemporaryFolder folder;
  // Large triangles would be seen at this contrast, but those of the plate drown in the noise of 0.07 K.
  folder.write("plan.toml", small_plan(2) + "[measurement]\nregistration_frames = 2\n");

  const Ended ended =
      todbench({"simulate", "./plan.toml", "--delta-t-k", "0.02", "--out", "session"}, {.folder = folder.path()});

  expect_refused(ended, 6, "plate \"tcat-a\" was not found");
  const Json provenance = Json::parse(content_of(folder.path() / "session" / "provenance.json"));
  EXPECT_EQ(provenance["state"], "interrupted");
}

TEST(Text, OfHelpAndVersionIsOnStandardOutputWithCodeZero) {
  for (const auto& arguments : std::vector<std::vector<std::string>>{{"--help"},
                                                                     {"--version"},
                                                                     {"simulate", "--help"},
                                                                     {"measure", "--help"},
                                                                     {"demo", "--help"},
                                                                     {"fit", "--help"},
                                                                     {"render", "--help"},
                                                                     {"mtf", "--help"},
                                                                     {"compare", "--help"},
                                                                     {"report", "--help"},
                                                                     {"devices", "--help"},
                                                                     {"emulate", "--help"}}) {
    const Ended ended = todbench(arguments);

    EXPECT_EQ(ended.code, 0) << arguments[0];
    EXPECT_GT(ended.out.size(), 10u) << arguments[0];
    EXPECT_EQ(ended.err, "") << arguments[0];
  }
}

TEST(Text, AFullStandardOutputIsAnErrorAndNotSilence) {
  const Ended ended = todbench({"mtf", "--sensor", "sc2000", "--frequency-per-pitch", "0.5", "--json"},
                               {.standard_output = "/dev/full"});

  expect_refused(ended, 7, "standard output cannot be written");
}

}  // namespace
}  // namespace todbench::testing
