// The whole job on the emulated laboratory.
#include "tests/system/system_test_support.h"

namespace todbench::testing {
namespace {

using ::testing::HasSubstr;

TEST(Demonstration, MeasuresSimulatesComparesReportsAndPasses) {
  const TemporaryFolder folder;

  const Ended ended = todbench({"demo", "--out", "d"}, {.folder = folder.path()});

  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("acuity measured [1/mrad]"));
  EXPECT_THAT(ended.out, HasSubstr("verdict: pass"));
  EXPECT_THAT(ended.out, HasSubstr("report: d/report.html"));
  expect_whole_session(folder.path() / "d", "complete");
  const std::string report = content_of(folder.path() / "d" / "report.html");
  EXPECT_THAT(report, HasSubstr("PASS"));
  EXPECT_THAT(report, HasSubstr("0.01 K/count, 250 K at 0 counts"));
  const Json comparison = Json::parse(content_of(folder.path() / "d" / "comparison.json"), nullptr, false);
  EXPECT_EQ(comparison["verdict"], "equivalent");
}

}  // namespace
}  // namespace todbench::testing
