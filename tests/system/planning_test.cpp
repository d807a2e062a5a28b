// SPDX-License-Identifier: GPL-3.0-or-later
// What the program says before it measures: effects, trials, uncertainty, time, and what a comparison can show.
#include "sim_devices/sensor/effect_list.h"
#include "tests/system/system_test_support.h"

namespace todbench::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::UnorderedElementsAre;

/// A folder with a plan, and the program run in it.
class Planning : public ::testing::Test {
 protected:
  Ended run(const std::vector<std::string>& arguments) { return todbench(arguments, {.folder = folder_.path()}); }
  std::filesystem::path at(const std::string& name) const { return folder_.path() / name; }
  void write(const std::string& name, const std::string& text) { folder_.write(name, text); }

 private:
  TemporaryFolder folder_;
};

Json effect_of(const Json& effects, const std::string& name) {
  for (const auto& effect : effects) {
    if (effect["name"] == name) return effect;
  }
  ADD_FAILURE() << "no effect " << name;
  return {};
}

TEST_F(Planning, JsonHasTheKeysOfTheContractAndOneDecisionPerEffect) {
  write("plan.toml", small_plan(8));

  const Ended ended = run({"plan", "./plan.toml", "--json"});

  ASSERT_EQ(ended.code, 0) << ended.err;
  const Json json = one_object(ended);
  EXPECT_THAT(keys_of(json),
              UnorderedElementsAre("effects", "trials", "predicted_uncertainty_percent", "predicted_s", "frontier"));
  ASSERT_EQ(json["effects"].size(), all_effects.size());
  for (const auto& effect : json["effects"]) {
    EXPECT_THAT(keys_of(effect), UnorderedElementsAre("name", "decision", "reason", "predicted_change_percent"));
    EXPECT_TRUE(effect["decision"] == "simulate" || effect["decision"] == "skip") << effect;
    EXPECT_GT(effect["reason"].get<std::string>().size(), 10u) << effect;
  }
  // Nothing bounds what leaving the footprint out would do; at 16.9 K noise of 0.07 K hardly matters.
  EXPECT_TRUE(effect_of(json["effects"], "detector")["predicted_change_percent"].is_null());
  EXPECT_EQ(effect_of(json["effects"], "detector")["decision"], "simulate");
  EXPECT_EQ(effect_of(json["effects"], "temporal_noise")["decision"], "skip");
  EXPECT_EQ(json["trials"], 8 * 20);  // phases times triangles of the plate
  EXPECT_GT(json["predicted_uncertainty_percent"].get<double>(), 1);
  EXPECT_LT(json["predicted_uncertainty_percent"].get<double>(), 30);
  EXPECT_GT(json["predicted_s"].get<double>(), 0);
}

TEST_F(Planning, ALargerToleranceSkipsNoLess) {
  write("plan.toml", small_plan(4));
  const auto skipped = [&](const char* percent) {
    const Json json =
        one_object(run({"plan", "./plan.toml", "--delta-t-k", "5", "--tolerance-percent", percent, "--json"}));
    std::set<std::string> names;
    for (const auto& effect : json["effects"]) {
      if (effect["decision"] == "skip") names.insert(effect["name"]);
    }
    return names;
  };

  const auto fine = skipped("0.5"), coarse = skipped("5");

  EXPECT_TRUE(std::includes(coarse.begin(), coarse.end(), fine.begin(), fine.end()));
  EXPECT_GT(coarse.size(), fine.size());
}

TEST_F(Planning, SkipAndForceAreObeyedAndTheReportSaysSo) {
  write("plan.toml", small_plan(4));
  const std::vector<std::string> asked{"--skip", "detector", "--force", "temporal_noise"};
  const auto with_asked = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), asked.begin(), asked.end());
    return run(arguments);
  };

  const Ended planned = with_asked({"plan", "./plan.toml", "--json"});
  const Ended simulated = with_asked({"simulate", "./plan.toml", "--out", "s", "--json"});

  ASSERT_EQ(planned.code, 0) << planned.err;
  EXPECT_THAT(planned.err, HasSubstr("effect detector is skipped on request: the tolerance is not guaranteed"));
  ASSERT_TRUE(completed(simulated));
  const Json before = one_object(planned)["effects"], after = one_object(simulated)["plan"];
  EXPECT_EQ(before, after);  // what was said is what was done
  EXPECT_EQ(effect_of(after, "detector")["decision"], "skip");
  EXPECT_THAT(effect_of(after, "detector")["reason"].get<std::string>(), HasSubstr("skipped on request"));
  EXPECT_EQ(effect_of(after, "temporal_noise")["decision"], "simulate");
  EXPECT_THAT(effect_of(after, "temporal_noise")["reason"].get<std::string>(), HasSubstr("simulated on request"));
  const std::string report = content_of(at("s") / "report.html");
  EXPECT_THAT(report, AllOf(HasSubstr("skipped on request"), HasSubstr("simulated on request"),
                            HasSubstr("the tolerance is not guaranteed")));
  const Json provenance = Json::parse(content_of(at("s") / "provenance.json"));
  EXPECT_EQ(effect_of(provenance["effects"], "detector")["decision"], "skip");
}

TEST_F(Planning, WhatTheCameraWillShowRestsOnItsOwnPhasesNotOnThoseOfTheSimulation) {
  const std::string limit = "[[limits.acuity]]\ndelta_t_k = 16.9\nleast_acuity_per_mrad = 0.3\n";
  const std::string alike = small_measurement(4, limit);
  std::string other = alike;
  other.replace(other.rfind("phases = 4"), 10, "phases = 16");
  write("alike.toml", alike);
  write("other.toml", other);

  const Json of_alike = one_object(run({"plan", "./alike.toml", "--json"}));
  const Json of_other = one_object(run({"plan", "./other.toml", "--json"}));

  EXPECT_EQ(of_other["trials"], 4 * of_alike["trials"].get<int>());
  EXPECT_EQ(of_other["limits"], of_alike["limits"]);
  ASSERT_EQ(of_other["frontier"].size(), of_alike["frontier"].size());
  for (std::size_t i = 0; i < of_alike["frontier"].size(); ++i)
    EXPECT_EQ(of_other["frontier"][i]["half_width_percent"], of_alike["frontier"][i]["half_width_percent"]) << i;
}

TEST_F(Planning, AComparisonThatThePlanCannotDecideIsWarnedOfBeforeAndAfter) {
  // 160 answers each: a standard error near 4 % each, where 10 % equivalence needs 3.25 % of the ratio.
  write("few.toml", small_measurement(8));
  // 8 x 320 answers each: near 1.5 %.
  write("many.toml",
        small_measurement(16, "[limits]\nequivalence_margin_percent = 30\n") + "[schedule]\nkind = \"constant\"\n");

  const Ended few = run({"plan", "./few.toml", "--json"});
  const Ended many = run({"plan", "./many.toml"});
  const Ended measured = run({"measure", "./few.toml", "--out", "m", "--json"});
  const Ended again = run({"measure", "./few.toml", "--out", "n", "--seed", "2", "--json"});
  const Ended compared = run({"compare", "m", "n", "--json"});

  ASSERT_EQ(few.code, 0) << few.err;
  EXPECT_THAT(few.err, AllOf(HasSubstr("warning: the plan is unlikely to show equivalence within 10 %"),
                             HasSubstr("80 % needs"), HasSubstr("(160 planned)")));
  ASSERT_EQ(many.code, 0) << many.err;
  EXPECT_THAT(many.err,
              AllOf(HasSubstr("equivalent within 30 %"), Not(HasSubstr("warning: the plan is unlikely to show"))));
  ASSERT_TRUE(completed(measured));
  ASSERT_TRUE(completed(again));
  EXPECT_THAT(measured.err, HasSubstr("the plan is unlikely to show equivalence within 10 %"));
  EXPECT_THAT(content_of(at("m") / "report.html"), HasSubstr("the plan is unlikely to show equivalence within 10 %"));
  ASSERT_TRUE(completed(compared));
  EXPECT_THAT(compared.err, AllOf(HasSubstr("warning: with this number of trials"), HasSubstr("(160 made)")));
}

TEST_F(Planning, NumbersOfFramesGoWithTheirContrasts) {
  write("plan.toml",
        "[target]\ndistance_m = 2\ndelta_t_k = [16.9, 0.23]\nphases = 2\n"
        "[schedule]\nframes_per_presentation = [2, 15]\n");

  const Ended ended = run({"plan", "./plan.toml", "--delta-t-k", "0.23,5,16.9", "--json"});

  EXPECT_EQ(ended.code, 0) << ended.err;
  int planned = 0;
  const Json plan = one_object(ended);
  for (const Json& row : plan["frontier"]) {
    if (!row["planned"]) continue;
    ++planned;
    ASSERT_EQ(row["frames_per_presentation"].size(), 3U);
    EXPECT_EQ(row["frames_per_presentation"][0], 15);
    EXPECT_GT(row["frames_per_presentation"][1], 0) << "5 K is not among those of the plan: chosen";
    EXPECT_EQ(row["frames_per_presentation"][2], 2);
  }
  EXPECT_EQ(planned, 1);
}

/// A simulated camera on a bench with the default times; both plates, all mountings.
std::string plan_of_a_bench(const std::string& more) {
  return "[target]\ndistance_m = 2\ndelta_t_k = [16.9, 1.93]\nphases = 8\n[simulation]\naccuracy = \"draft\"\n" + more;
}

TEST_F(Planning, DecideShowsBenchTimeAgainstTheProbabilityOfEachDecision) {
  write("plan.toml", plan_of_a_bench("[limits]\nfleet_sd_percent = 4\n[[limits.acuity]]\ndelta_t_k = 1.93\n"
                                     "least_acuity_per_mrad = 0.46\n[[uncertainty.component]]\nname = \"distance\"\n"
                                     "value = 10\nunit = \"mm\"\n"));

  const Ended ended = run({"plan", "./plan.toml", "--decide", "--json"});
  const Ended text = run({"plan", "./plan.toml", "--decide"});

  ASSERT_EQ(ended.code, 0) << ended.err;
  const Json decide = one_object(ended)["decide"];
  ASSERT_EQ(decide.size(), 1U);
  EXPECT_EQ(decide[0]["delta_t_k"], 1.93);
  // 10 mm of 2 m: 0.5 %, 0.98 % at 95 %; 0.32 of it is the smallest half-width that matters.
  EXPECT_NEAR(decide[0]["budget_half_width_percent"].get<double>(), 0.98, 0.01);
  EXPECT_NEAR(decide[0]["smallest_half_width_percent"].get<double>(), 0.314, 0.01);
  EXPECT_EQ(decide[0]["rows"][0]["name"], "distance");
  int planned = 0;
  for (const Json& design : decide[0]["designs"]) {
    EXPECT_GT(design["bench_s"].get<double>(), 300);
    planned += design["planned"] ? 1 : 0;
    ASSERT_EQ(design["cameras"].size(), 21U);
    for (const Json& camera : design["cameras"]) {
      EXPECT_NEAR(
          camera["p_pass"].get<double>() + camera["p_fail"].get<double>() + camera["p_inconclusive"].get<double>(), 1,
          1e-9);
    }
    EXPECT_LT(design["consumer_risk"].get<double>(), 0.025);
  }
  EXPECT_EQ(planned, 1);
  EXPECT_THAT(text.out, AllOf(HasSubstr("The smallest half-width of the trials that matters is 0.31 %"),
                              HasSubstr("bench times are those of a laboratory with the change times of the plan"),
                              HasSubstr("decisions of the planned design")));
}

TEST_F(Planning, DecideShowsTheHalfWidthsOfAdaptiveDesigns) {
  write("plan.toml", plan_of_a_bench("[schedule]\nkind = \"adaptive\"\nhalf_width_percent = 4\n[[limits.acuity]]\n"
                                     "delta_t_k = 1.93\nleast_acuity_per_mrad = 0.46\n"));

  const Ended ended = run({"plan", "./plan.toml", "--decide", "--json"});
  const Ended text = run({"plan", "./plan.toml", "--decide"});

  ASSERT_EQ(ended.code, 0) << ended.err;
  const Json json = one_object(ended);
  std::set<double> asked;
  for (const Json& design : json["decide"][0]["designs"])
    asked.insert(design["asked_half_width_percent"].get<double>());
  EXPECT_EQ(asked, (std::set<double>{1, 2, 4, 8, 16}));
  EXPECT_THAT(text.out, HasSubstr("half-width asked [%]"));
}

TEST_F(Planning, OptimiseWritesAFasterPlanThatPlanAndSimulateTake) {
  write("plan.toml", plan_of_a_bench(""));

  const Ended found = run({"plan", "./plan.toml", "--optimise", "--half-width", "8", "--out", "best.toml", "--json"});
  const Ended planned = run({"plan", "./best.toml", "--json"});
  const Ended simulated = run({"simulate", "./best.toml", "--out", "s", "--json"});

  ASSERT_EQ(found.code, 0) << found.err;
  const Json json = one_object(found);
  EXPECT_LT(json["bench_s"], json["as_planned"]["bench_s"]);
  EXPECT_EQ(json["bench_s"], json["optimised"]["bench_s"]);
  EXPECT_THAT(content_of(at("best.toml")), HasSubstr(" s of bench time with half-widths of at most "));
  EXPECT_LT(json["set_ups"], 8);
  EXPECT_EQ(json["optimised"]["mountings_per_plate"].size(), 2U);
  ASSERT_EQ(planned.code, 0) << planned.err;
  EXPECT_LE(one_object(planned)["predicted_uncertainty_percent"].get<double>(), 8);
  ASSERT_TRUE(completed(simulated));
  std::set<std::string> set_ups;
  for (const std::string& line : lines_of(content_of(at("s") / "targets.csv"))) {
    for (const char* plate : {"tcat-a", "tcat-b"}) {
      for (const char* mounting : {"identity", "rotated_180", "mirrored_horizontally", "mirrored_vertically"}) {
        if (line.find(plate) != std::string::npos && line.find(mounting) != std::string::npos)
          set_ups.insert(std::string(plate) + mounting);
      }
    }
  }
  EXPECT_EQ(set_ups.size(), json["set_ups"].get<std::size_t>());
}

TEST_F(Planning, OptimiseRejectsAHalfWidthThatNoDesignHas) {
  write("plan.toml", plan_of_a_bench(""));

  expect_refused(run({"plan", "./plan.toml", "--optimise", "--half-width", "0.02"}), 2, "at best");
}

TEST_F(Planning, TimeToMeasureStatesItsDifferenceFromTheBill) {
  const Ended text = run({"plan", "demo"});
  const Ended json = run({"plan", "demo", "--json"});

  ASSERT_EQ(json.code, 0) << json.err;
  const std::string before = " s (the bill of ";
  const std::size_t bill = text.out.find(before);
  ASSERT_NE(bill, std::string::npos) << text.out;
  EXPECT_NEAR(std::stod(text.out.substr(bill + before.size())), one_object(json)["bill"]["total_s"].get<double>(),
              0.06);
  EXPECT_THAT(text.out, HasSubstr(" s of computing)"));
  for (const Json& row : one_object(json)["frontier"]) {
    if (row["planned"]) {
      EXPECT_EQ(row["predicted_s"], one_object(json)["predicted_measurement_s"]);
    }
  }
}

TEST_F(Planning, NeutralEffectsShareALineAndStateTheirReasonsOnRequest) {
  write("plan.toml", small_plan(8));

  const Ended folded = run({"plan", "./plan.toml"});
  const Ended why = run({"plan", "./plan.toml", "--why"});
  const Ended simulated = run({"simulate", "./plan.toml", "--out", "folded"});
  const Ended simulated_why = run({"simulate", "./plan.toml", "--out", "why", "--why"});

  EXPECT_THAT(folded.out,
              AllOf(HasSubstr("neutral in this sensor, so skipped"), Not(HasSubstr("frames_averaged is 1"))));
  EXPECT_THAT(why.out, HasSubstr("frames_averaged is 1"));
  EXPECT_THAT(simulated.out, AllOf(HasSubstr("--why"), Not(HasSubstr("frames_averaged is 1"))));
  EXPECT_THAT(simulated_why.out, HasSubstr("frames_averaged is 1"));
}

}  // namespace
}  // namespace todbench::testing
