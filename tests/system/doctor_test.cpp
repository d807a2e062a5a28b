// SPDX-License-Identifier: GPL-3.0-or-later
// todbench doctor as a user runs it: on this system, and on one of files.
#include "tests/system/system_test_support.h"

namespace todbench::testing {
namespace {

using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::UnorderedElementsAre;

TEST(DoctorCommand, TellsEveryCheckOfThisSystemAsJson) {
  const TemporaryFolder folder;

  const Ended ended = todbench({"doctor", "--json"}, {.folder = folder.path()});

  const Json json = one_object(ended);
  EXPECT_THAT(keys_of(json), UnorderedElementsAre("checks", "verdict"));
  EXPECT_EQ(json["checks"].size(), 9U);  // the ninth is the library of the cameras
  bool problem = false;
  for (const auto& check : json["checks"]) {
    EXPECT_THAT(keys_of(check), UnorderedElementsAre("name", "finding", "found", "explanation", "command"));
    EXPECT_THAT(check["finding"].get<std::string>(), AnyOf("ok", "warning", "problem", "unknown"));
    problem = problem || check["finding"] == "problem";
  }
  EXPECT_EQ(ended.code, problem ? 1 : 0);
  EXPECT_EQ(json["verdict"], problem ? "problem" : "ok");
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(DoctorCommand, PrintsTheCommandThatMendsASmallSocketBufferAndEndsWithOne) {
  const TemporaryFolder folder;
  folder.write("proc/sys/net/core/rmem_max", "212992\n");

  const Ended ended = todbench({"doctor", "--root", folder.path().string()}, {.folder = folder.path()});

  EXPECT_EQ(ended.code, 1) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("sudo sysctl -w net.core.rmem_max="));
}

TEST(DoctorCommand, EndsWithZeroWhenNothingStandsInTheWay) {
  const TemporaryFolder folder;
  folder.write("proc/sys/net/core/rmem_max", "16777216\n");

  const Ended ended = todbench({"doctor", "--root", folder.path().string(), "--json"}, {.folder = folder.path()});

  EXPECT_EQ(ended.code, 0) << ended.out;
  EXPECT_EQ(one_object(ended)["verdict"], "ok");
}

TEST(DoctorCommand, WarnsWhereTheDisplayOfAPlanLimitsTheAcuity) {
  const TemporaryFolder folder;
  folder.write("proc/sys/net/core/rmem_max", "16777216\n");
  const std::string scene =
      "[target]\nkind = \"scene\"\ndistance_m = 2\nplates = [\"tcat-a\"]\ndelta_t_k = [16.9]\n[simulation]\nsensor = "
      "\"sc2000\"\n[observer]\nname = \"hvs-2\"\n[display]\npixel_pitch_mm = 0.25\nluminance_white_cd_m2 = 100\n";
  folder.write("far.toml", scene + "viewing_distance_m = 2\n");
  folder.write("near.toml", scene + "viewing_distance_m = 0.5\nzoom = 6\n");
  const auto limits = [&](const std::string& plan) {
    return one_object(
        todbench({"doctor", "--root", folder.path().string(), "--plan", plan, "--json"}, {.folder = folder.path()}));
  };

  const auto finding = [](const Json& said) {
    for (const Json& check : said["checks"])
      if (check["name"] == "acuity") return check["finding"].get<std::string>();
    return std::string();
  };

  const Json far = limits("far.toml"), near = limits("near.toml");

  EXPECT_EQ(finding(far), "warning");
  EXPECT_THAT(far["acuity_limits"][0]["limited_by"].get<std::string>(), AnyOf("eye", "light", "display"));
  EXPECT_EQ(finding(near), "ok");
  EXPECT_EQ(near["acuity_limits"][0]["limited_by"], "sampling");
}

TEST(DoctorCommand, RefusesAPlanWithAModuleWhoseLimitsItDoesNotKnow) {
  const TemporaryFolder folder;
  const std::string scene =
      "[target]\nkind = \"scene\"\ndistance_m = 2\nplates = [\"tcat-a\"]\ndelta_t_k = [16.9]\n[simulation]\nsensor = "
      "\"sc2000\"\n";
  folder.write("module.toml", scene + "[[module]]\ncommand = \"cat\"\n");
  folder.write("seen.toml", scene + "[[module]]\ncommand = \"cat\"\n[observer]\nname = \"hvs-2\"\n[display]\n" +
                                "pixel_pitch_mm = 0.25\nluminance_white_cd_m2 = 100\nviewing_distance_m = 0.5\n");
  const auto run = [&](const std::vector<std::string>& arguments) {
    return todbench(arguments, {.folder = folder.path()});
  };

  for (const char* plan : {"module.toml", "seen.toml"}) {
    expect_refused(run({"doctor", "--root", folder.path().string(), "--plan", plan}), 2, "do not include the modules");
    expect_refused(run({"plan", plan, "--what-limits"}), 2, "[[module]]");
  }
}

TEST(DoctorCommand, RefusesAFolderThatIsNotThere) {
  const TemporaryFolder folder;

  const Ended ended = todbench({"doctor", "--folder", "nowhere"}, {.folder = folder.path()});

  expect_refused(ended, 2, "nowhere");
}

}  // namespace
}  // namespace todbench::testing
