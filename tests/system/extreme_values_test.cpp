// SPDX-License-Identifier: GPL-3.0-or-later
// No number of a plan or of an option ends as NaN or infinity: it is refused in a sentence, or the result is finite.
#include "tests/system/extreme_values.h"

#include <set>

namespace todbench::testing {
namespace {

TEST(ExtremeValues, OfAPlanAreRefusedWithAKeyOrInItsRange) {
  std::set<std::string> keys;
  std::size_t refused = 0, accepted = 0;
  for (const ExtremePlan& extreme : extreme_plans(plan_of_every_section())) {
    const std::string path = path_of(*extreme.at.section, *extreme.at.key), about = path + " = " + extreme.value;
    keys.insert(path);
    const auto plan = parse_plan({"plan.toml", extreme.toml}, ".");
    if (plan) {
      ++accepted;
      EXPECT_TRUE(mistakes_in(*plan).empty()) << about;
      continue;
    }
    ++refused;
    EXPECT_EQ(plan.error().code, ErrorCode::invalid_input) << about;
    EXPECT_TRUE(plan.error().key) << about << ": " << plan.error().message;
  }
  EXPECT_GT(keys.size(), 60u);
  EXPECT_GT(accepted, keys.size() / 2);
  EXPECT_GT(refused, 3 * keys.size());
}

TEST(ExtremeValues, InAnotherUnitAreRefusedWithItsName) {
  const Plan plan = plan_of_every_section();
  const std::pair<const char*, const char*> mistakes[] = {{"target.distance_m", "2e6"},
                                                          {"target.delta_t_k", "[2000.0]"},
                                                          {"target.settle_timeout_s", "6e10"},
                                                          {"measurement.max_readback_deviation_k", "50.0"}};
  for (const auto& [path, value] : mistakes) {
    const auto read = parse_plan({"plan.toml", with_key(plan, plan_key(path), value)}, ".");

    ASSERT_FALSE(read) << path;
    EXPECT_THAT(read.error().message, ::testing::HasSubstr("; is the value in ")) << path;
  }
}

// A part of the accepted values; the rest is extreme_values_study.
TEST(ExtremeValues, ThatAPlanMayHaveGiveFiniteNumbers) {
  const TemporaryFolder folder;
  int accepted = 0;
  for (const ExtremePlan& extreme : extreme_plans(plan_of_every_section())) {
    if (!parse_plan({"plan.toml", extreme.toml}, ".") || ++accepted % 40 != 0) continue;
    folder.write("plan.toml", extreme.toml);
    const Ended ended =
        todbench({"simulate", "./plan.toml", "--out", std::to_string(accepted), "--json"}, {.folder = folder.path()});
    expect_refused_or_finite(ended, path_of(*extreme.at.section, *extreme.at.key) + " = " + extreme.value);
  }
}

TEST(ExtremeValues, OfOptionsAreRefused) {
  const std::vector<OptionCommand> commands = {
      {{"doctor"}, {}},
      {{"emulate"}, {}},
      {{"cost"}, {"demo"}},
      {{"plan"}, {"demo", "--optimise"}},
      {{"record"}, {"sim:sc2000"}},
      {{"watch"}, {"sim:sc2000"}},
      {{"compare"}, {"a", "b"}},
      {{"render"}, {"--sensor", "sc2000", "--size-pitch", "3"}},
      {{"mtf"}, {"--sensor", "sc2000", "--frequency-per-pitch", "0.1"}},
      {{"noise"}, {"no.todrec"}},
      {{"plate"}, {"tcat-a", "--svg", "p.svg"}},
      {{"pattern"}, {"tod", "--pixels", "64", "64", "--out", "p.tiff", "--format", "tiff"}},
      {{"picture"}, {"vehicle-in-field", "--sensor", "sc2000", "--range-m", "1000", "--out", "o"}},
      {{"identify"}, {"vehicles", "--sensor", "sc2000", "--ranges", "1000"}},
      {{"mrtd"}, {"--sensor", "sc2000"}},
      {{"sfr"}, {"no.tiff"}},
      {{"conformity"}, {"--value", "1", "--u", "0.1", "--at-least", "0.5"}},
      {{"range"}, {"--tod", "a", "--size-m", "2", "--delta-t-k", "2"}},
      {{"enhance"}, {"demo", "--packages", "no.toml"}},
      {{"scene-dependence"}, {"demo"}},
      {{"dynamic"}, {"--speeds-mrad-s", "20"}},
      {{"history", "show"}, {"x"}},
      {{"history", "check"}, {}},
      {{"blind"}, {"m", "--simulated-person", "--out", "b"}},
      {{"judge"}, {"a", "--bars", "--out", "o"}},
      {{"observer", "fit"}, {"a", "--from", "hvs-1", "--free", "internal_noise", "--out", "o.toml"}},
      {{"observer", "naked-eye"}, {"demo", "--out", "naked"}},
      {{"sweep", "run"}, {"no.toml"}},
      {{"module", "check"}, {"cat"}}};
  const TemporaryFolder folder;
  std::size_t options = 0;
  std::set<std::string> tried;
  for (const OptionCommand& command : commands) {
    tried.insert(command.command.front());
    const auto numeric = numeric_options(command.command);
    EXPECT_FALSE(numeric.empty()) << command.command.front();
    for (const ExtremeOption& option : numeric) {
      ++options;
      for (const std::string& value : {std::string("1e308"), std::string("nan")})
        expect_refused(todbench(with_option(command, option, value), {.folder = folder.path()}), 2, "");
    }
  }
  EXPECT_GT(options, 100u);
  for (const std::string& command : lines_of(todbench({"complete", ""}).out)) {
    const bool none = tried.contains(command) || numeric_options({command}).empty();
    EXPECT_TRUE(none) << command << " is not tried";
  }
}

}  // namespace
}  // namespace todbench::testing
