// SPDX-License-Identifier: GPL-3.0-or-later
// Names that cameras, instruments, files and networks chose to move the cursor of whoever reads them.
#include "acquisition/base/safe_text.h"
#include "acquisition/recording/frame_stream.h"
#include "bench/session/session_folder.h"
#include "sim_devices/lab/instruments/black_body.h"
#include "sim_devices/lab/instruments/scpi_server.h"
#include "tests/system/system_test_support.h"

namespace todbench::testing {
namespace {

using ::testing::HasSubstr;

/// Clears the screen, rings, sets colours by a C1 control, turns the line round, and is no UTF-8.
const std::string steering =
    "A\x1b[2J\x07\xC2\x9B"
    "31m\xE2\x80\xAE\xFF\x9B"
    "B";
/// The same in TOML, which is valid UTF-8.
const std::string steering_toml = "A\\u001b[2J\\u0007\\u009b31m\\u202eB";

void expect_harmless(const std::string& text, const std::string& from) {
  EXPECT_EQ(valid_text(text), text) << from;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    ASSERT_TRUE(c == '\n' || (byte >= 0x20 && byte != 0x7f)) << from << ": " << static_cast<int>(byte);
  }
}

void expect_harmless(const Ended& ended, const std::string& from) {
  expect_harmless(ended.out, from + ", standard output");
  expect_harmless(ended.err, from + ", standard error");
}

class SteeringText : public ::testing::Test {
 protected:
  Ended run(const std::vector<std::string>& arguments) const {
    ChildOptions options;
    options.folder = folder_.path();
    Ended ended = todbench(arguments, options);
    expect_harmless(ended, arguments.front());
    return ended;
  }
  /// A recording of a camera with such names.
  void record(const std::string& file, const std::string& name) const {
    StreamHeader header;
    header.info.id = "gige:" + name;
    header.info.vendor = header.info.model = header.info.serial = header.info.firmware = name;
    header.info.pixel_format = "Mono16";
    header.info.width = header.info.height = 8;
    header.info.significant_bits = 16;
    header.info.settings = {{name, name}};
    header.info.warnings = {"warning of " + name};
    auto writer = FrameStreamWriter::create(folder_.path() / file, header);
    ASSERT_TRUE(writer) << writer.error().message;
  }

  TemporaryFolder folder_;
};

TEST_F(SteeringText, OfACameraReachesNoTerminal) {
  for (const std::string& name : {steering, steering + std::string(1000000, 'x')}) {
    record("a.todrec", name);

    for (const auto& command : std::vector<std::vector<std::string>>{{"record", "file:a.todrec", "--out", "b.todrec"},
                                                                     {"noise", "a.todrec"}}) {
      const Ended ended = run(command);
      EXPECT_LT(ended.err.size(), 50000u);
    }
    std::filesystem::remove(folder_.path() / "b.todrec");
  }
}

TEST_F(SteeringText, OfAnInstrumentReachesNoTerminal) {
  const auto impostor = ScpiServer::start({}, {steering + "," + steering + ",\"" + steering + "\",1", {}}).value();
  folder_.write("plan.toml", small_plan(2) + "[camera]\nid = \"sim:sc2000\"\nifov_mrad = 1.3\n");
  std::string plan = content_of(folder_.path() / "plan.toml");
  plan.insert(plan.find("distance_m"), "kind = \"scpi\"\nblack_body = \"" + impostor->endpoint() + "\"\nstage = \"" +
                                           impostor->endpoint() + "\"\n");
  folder_.write("plan.toml", plan);

  const Ended ended = run({"measure", "./plan.toml", "--out", "m"});

  EXPECT_NE(ended.code, 0);
  EXPECT_THAT(ended.err, HasSubstr("black body"));
}

TEST_F(SteeringText, OfFilesAndTheirNamesReachesNoTerminal) {
  folder_.write("plan.toml", small_measurement(2));
  std::string plan = content_of(folder_.path() / "plan.toml");
  plan.replace(plan.find("sim:sc2000"), 10, "gige:" + steering_toml);
  folder_.write("camera.toml", plan);
  folder_.write("key.toml", "[target]\n\"" + steering_toml + "\" = 1\n");
  folder_.write("trials.csv", steering + ",correct,total\n1,2,3\n");
  folder_.write("row.csv", "size,correct,total\n" + steering + ",2,3\n");

  EXPECT_NE(run({"measure", "./camera.toml", "--out", "m"}).code, 0);
  EXPECT_EQ(run({"simulate", "./key.toml", "--out", "s"}).code, 2);
  EXPECT_EQ(run({"fit", "trials.csv"}).code, 2);
  EXPECT_EQ(run({"fit", "row.csv"}).code, 2);
  EXPECT_EQ(run({"report", steering}).code, 2);
  EXPECT_EQ(run({"verify", steering}).code, 2);
  EXPECT_EQ(run({steering}).code, 2);
  EXPECT_EQ(run({"fit", "--" + steering}).code, 2);
}

TEST_F(SteeringText, OfAPlanStandsEscapedInFilesAndJson) {
  folder_.write("plan.toml",
                "description = \"" + steering_toml + "\"\nunit = \"" + steering_toml + "\"\n" + small_plan(2));
  ASSERT_TRUE(completed(run({"simulate", "./plan.toml", "--out", "s", "--json"})));
  folder_.write("s/" + steering, "x");

  const Ended verify = run({"verify", "s", "--json"});

  EXPECT_EQ(one_object(verify)["foreign"].size(), 1u);
  run({"verify", "s"});
  for (const char* file : {"report.html", "provenance.json", "log.txt", "trials.csv", "curve.csv", "verdict.json"})
    expect_harmless(content_of(folder_.path() / "s" / file), file);
}

}  // namespace
}  // namespace todbench::testing
