// SPDX-License-Identifier: GPL-3.0-or-later
// The program before a GigE Vision camera whose description would end, fill or stop it: one sentence, exit code 4.
#include <signal.h>

#include "sim_devices/lab/gige/gvsp_camera.h"
#include "tests/system/system_test_support.h"

namespace todbench::testing {
namespace {

using ::testing::HasSubstr;

std::unique_ptr<GvspCamera> start(GvspCameraConfig config) {
  auto camera = GvspCamera::start(config, [w = config.width, h = config.height](std::uint64_t index) {
    return cv::Mat1w(h, w, static_cast<ushort>(7000 + index % 100));
  });
  EXPECT_TRUE(camera) << camera.error().message;
  return camera ? std::move(*camera) : nullptr;
}

/// A description whose width has a circular reference.
std::string endless_description() {
  std::string xml = genicam_xml(describe_camera(CameraModel::ax5, {}).genicam);
  const std::string value = "<pValue>WidthRegister</pValue>";
  return xml.replace(xml.find(value), value.size(), "<pValue>Width</pValue>");
}

std::vector<std::string> record_command() {
  return {"record", "gige:127.0.0.1", "--frames", "3", "--out", "r.todrec"};
}

std::string measured_plan() {
  return "name = \"hostile\"\n[camera]\nid = \"gige:127.0.0.1\"\nifov_mrad = 1\n[target]\nkind = \"prompt\"\n"
         "distance_m = 2\nplates = [\"tcat-a\"]\nmountings = [\"identity\"]\ndelta_t_k = [5]\nphases = 4\n";
}

TEST(HostileCamera, EndsNoCommand) {
  GvspCameraConfig config;
  config.description = endless_description();
  const auto camera = start(config);
  const TemporaryFolder folder;
  folder.write("plan.toml", measured_plan());

  const Ended recorded = todbench(record_command(), {.folder = folder.path()});
  const Ended measured = todbench({"measure", "./plan.toml", "--out", "s"}, {.folder = folder.path()});
  const Ended listed = todbench({"devices"}, {.folder = folder.path()});

  EXPECT_EQ(recorded.code, 4) << recorded.err;
  EXPECT_THAT(lines_of(recorded.err).back(), HasSubstr("node Width: its value has a circular reference"));
  EXPECT_EQ(measured.code, 4) << measured.err;
  EXPECT_THAT(lines_of(measured.err).back(), HasSubstr("node Width: its value has a circular reference"));
  EXPECT_EQ(listed.code, 0) << listed.err;
  EXPECT_THAT(listed.out, HasSubstr("gige:FLIR-TB0002"));
}

TEST(HostileCamera, HasNoDeviceOfTheHostRead) {
  GvspCameraConfig config;
  config.description_url = "File:/dev/zero";
  const auto camera = start(config);
  const TemporaryFolder folder;

  const Ended ended = todbench(record_command(), {.folder = folder.path()});

  EXPECT_EQ(ended.code, 4) << ended.err;
  EXPECT_THAT(lines_of(ended.err).back(), HasSubstr("/dev/zero, which is empty or not a regular file"));
}

TEST(SlowCamera, TellsHowFarItIsAndIsLeftOnAStopRequest) {
  GvspCameraConfig config;
  config.memory_delay = std::chrono::milliseconds(200);
  const auto camera = start(config);
  const TemporaryFolder folder;
  ChildProcess child(todbench_command(record_command()), {.folder = folder.path()});
  ASSERT_TRUE(
      child.wait_until([&] { return child.err().find("reading the camera's description: ") != std::string::npos; }));

  child.signal(SIGINT);
  const Ended ended = child.wait();

  EXPECT_EQ(ended.code, 130) << ended.err;
  EXPECT_THAT(lines_of(ended.err).back(), HasSubstr("stopped on request"));
}

}  // namespace
}  // namespace todbench::testing
