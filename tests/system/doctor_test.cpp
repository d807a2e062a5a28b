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
  EXPECT_EQ(json["checks"].size(), 8U);
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

TEST(DoctorCommand, RefusesAFolderThatIsNotThere) {
  const TemporaryFolder folder;

  const Ended ended = todbench({"doctor", "--folder", "nowhere"}, {.folder = folder.path()});

  expect_refused(ended, 2, "nowhere");
}

}  // namespace
}  // namespace todbench::testing
