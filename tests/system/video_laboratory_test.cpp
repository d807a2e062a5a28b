// SPDX-License-Identifier: GPL-3.0-or-later
// A measurement with an emulated V4L2 camera in a process of its own: the plan of the laboratory with one line changed.
#include "tests/system/system_test_support.h"

namespace todbench::testing {
namespace {

using ::testing::HasSubstr;

class VideoLaboratories : public ::testing::TestWithParam<std::string> {};

TEST_P(VideoLaboratories, AMeasurementThroughADeviceNodeIsAWholeSession) {
  const TemporaryFolder folder;
  ChildProcess laboratory(
      todbench_command({"emulate", "--json", "--camera", GetParam(), "--black-body-port", "0", "--stage-port", "0"}));
  ASSERT_TRUE(laboratory.wait_until([&] { return laboratory.out().find('\n') != std::string::npos; }))
      << laboratory.wait().err;
  const Json lab = Json::parse(laboratory.out(), nullptr, false);
  ChildOptions client{.folder = folder.path()};
  for (const auto& [name, value] : lab["camera"]["environment"].items()) client.setenv[name] = value;
  folder.write("plan.toml",
               "name = \"video\"\n[camera]\nid = \"" + lab["camera"]["id"].get<std::string>() +
                   "\"\nifov_mrad = 1.3085399449\n[simulation]\naccuracy = \"draft\"\nphases = 4\n[measurement]\n"
                   "registration_frames = 4\ncontrast_frames = 4\n[target]\nkind = \"scpi\"\nblack_body = \"" +
                   lab["black_body"].get<std::string>() + "\"\nstage = \"" + lab["stage"].get<std::string>() +
                   "\"\ndistance_m = 2\nplates = [\"tcat-a\"]\nmountings = [\"identity\"]\ndelta_t_k = [16.9]\n"
                   "phases = 4\n");

  const Ended devices = todbench({"devices", "--json"}, client);
  const Ended measured = todbench({"measure", "./plan.toml", "--out", "m", "--json"}, client);

  EXPECT_THAT(devices.out, HasSubstr(lab["camera"]["id"].get<std::string>()));
  ASSERT_TRUE(completed(measured)) << measured.err;
  EXPECT_EQ(one_object(measured)["points"][0]["trials"], 4 * 20);
  expect_whole_session(folder.path() / "m", "complete");
  const Json provenance = Json::parse(content_of(folder.path() / "m" / "provenance.json"));
  EXPECT_EQ(provenance["camera"]["transport"], "V4L2 (uvcvideo)");
}

INSTANTIATE_TEST_SUITE_P(Every, VideoLaboratories, ::testing::Values("v4l2", "v4l2-yuyv"), [](const auto& chosen) {
  return chosen.param == "v4l2" ? std::string("Lepton") : std::string("TemperatureRows");
});

}  // namespace
}  // namespace todbench::testing
