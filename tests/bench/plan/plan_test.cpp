// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/plan/plan.h"

#include <gmock/gmock.h>

#include "bench/plan/loaded_plan.h"
#include "bench/plan/plan_options.h"
#include "tests/support/source_file.h"
#include "tests/support/temporary_folder.h"

namespace todbench {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

Result<Plan> parse(const std::string& text) {
  return parse_plan({"plan.toml", text}, "");
}

/// A plan in which nothing has its default.
Plan unusual_plan() {
  Plan plan;
  plan.name = "acceptance \"A\"";
  plan.description = "two\nlines, a \\ and a tab\t";
  plan.operator_name = "Zoë";
  plan.place = "hall 3";
  plan.unit = "unit 17";
  plan.notes = "\x01";
  plan.seed = 9223372036854775807u;
  plan.camera = {.id = "gige:FLIR-48000123",
                 .ifov_mrad = 1.0 / 3,
                 .nuc_interval_s = 120,
                 .nuc_wait_s = 1.5,
                 .settings = {{"IRFormat", "TemperatureLinear10mK"}, {"Odd Key.x", "1"}},
                 .reconnect_s = 60,
                 .contrast = ContrastUnit::kelvin,
                 .frame_size = "640x512",
                 .nuc_command = "Calibrate"};
  plan.target.kind = TargetKind::scpi;
  plan.target.black_body = "10.0.0.7:5025";
  plan.target.stage = "[::1]:5026";
  plan.target.distance_m = 2.0625;
  plan.target.plates = {"tcat-b"};
  plan.target.mountings = {Mounting::rotated_180, Mounting::identity};
  plan.target.delta_t_k = {-5, 1e-3};
  plan.target.phases = 7;
  plan.target.settle_timeout_s = 90;
  plan.target.plate_change_s = 1;
  plan.target.mounting_change_s = 2;
  plan.target.contrast_change_s = 3;
  plan.target.shift_change_s = 0;
  plan.observer = "human-like-1";
  plan.simulation.accuracy = "draft";
  plan.simulation.tolerance_percent = 2.5;
  plan.simulation.microscan = 2;
  plan.simulation.phases = 64;
  plan.simulation.skip = {Effect::quantisation, Effect::aberration};
  plan.simulation.force = {Effect::detector};
  plan.schedule = {.kind = ScheduleKind::adaptive, .half_width_percent = 7.5, .max_presentations = 321};
  plan.fit = {.form = PsychometricForm::acuity, .lapse = std::nullopt};
  plan.limits.acuity = {{-5, 0.4}, {1e-3, 0.1}};
  plan.limits.equivalence_margin_percent = 12.5;
  plan.measurement = {8, 4, 3.5, 0, 0.25, 0.125, 500, 0.05, 5, 0.5, 0.001};
  plan.instruments = {{"black body", "BB-1", "C-77", "2027-02-28"}, {"ruler", "", "", ""}};
  return plan;
}

Plan plan_with_budget() {
  Plan plan;
  plan.uncertainty.rows = {{.name = "distance",
                            .value = 2.5,
                            .distribution = BudgetDistribution::rectangular,
                            .degrees_of_freedom = 12.5,
                            .unit = "mm",
                            .source = "tape",
                            .certificate = "K-17",
                            .common = {BudgetCommon::twin, BudgetCommon::series}},
                           {.name = "focus",
                            .value = 0,
                            .coverage_factor = 2,
                            .sensitivity = -0.5,
                            .unit = "mm",
                            .enters = BudgetInput::contrast}};
  return plan;
}

Plan plan_with_rule() {
  Plan plan;
  plan.measures.noise = plan.measures.transfer = true;
  plan.limits.measures = {{"noise_tvh", std::nullopt, 0.05}, {"transfer_slope", 0.9, 1.1}};
  plan.limits.rule = ConformityRule::non_binary;
  plan.limits.guard_band_risk = 0.01;
  plan.limits.fleet_sd_percent = 4;
  plan.limits.fleets = {{.delta_t_k = 0.23, .mean = 0.3, .sd = 0.04, .u = 0.02, .units = 14, .source = "SC2000"},
                        {.measure = "netd", .mean = 0.06, .sd = 0.004, .units = 10}};
  return plan;
}

Plan graded_plan() {
  Plan plan;
  plan.schedule.answers = AnswersChoice::graded;
  plan.schedule.frames_per_presentation = {4};
  plan.fit.estimator = EstimatorChoice::twin_shape;
  return plan;
}

TEST(Plan, WhatIsWrittenReadsBackEqual) {
  for (const Plan& plan : {Plan{}, unusual_plan(), graded_plan(), plan_with_budget(), plan_with_rule()}) {
    const Result<Plan> back = parse(to_toml(plan));

    ASSERT_TRUE(back) << back.error().message << "\n" << to_toml(plan);
    EXPECT_EQ(*back, plan) << to_toml(plan);
    EXPECT_EQ(to_toml(*back), to_toml(plan));
  }
}

TEST(Plan, WithoutABudgetIsWrittenWithoutOne) {
  EXPECT_THAT(to_toml(unusual_plan()), Not(HasSubstr("uncertainty")));
}

TEST(Plan, ReadsABudgetByTheWordsOfItsFile) {
  const Result<Plan> plan = parse(
      "[[uncertainty.row]]\nname = 'distance'\nvalue = 2\nkind = 'rectangular half-width'\nnu = 9\nunit = 'mm'\n"
      "[[uncertainty.row]]\nname = 'Air_path'\nvalue = 1\nunit = '%'\n");

  ASSERT_TRUE(plan) << plan.error().message;
  ASSERT_EQ(plan->uncertainty.rows.size(), 2u);
  EXPECT_EQ(plan->uncertainty.rows[0].distribution, BudgetDistribution::rectangular);
  EXPECT_EQ(plan->uncertainty.rows[0].degrees_of_freedom, 9);
  EXPECT_EQ(input_of(plan->uncertainty.rows[1]), BudgetInput::air_path);
}

TEST(Plan, RefusesAFleetThatIsWrong) {
  const auto refused = [](const std::string& keys) {
    return !parse("[[limits.fleet]]\nmean = 0.3\nsd = 0.04\n" + keys).has_value();
  };
  EXPECT_FALSE(refused("units = 10\nmeasure = 'acuity'\ndelta_t_k = 0.23\n"));
  EXPECT_TRUE(refused("units = 9\nmeasure = 'acuity'\ndelta_t_k = 0.23\n")) << "too few";
  EXPECT_TRUE(refused("units = 10\nmeasure = 'acuity'\n")) << "at what contrast?";
  EXPECT_TRUE(refused("units = 10\nmeasure = 'weight'\n"));
  EXPECT_TRUE(
      refused("units = 10\nmeasure = 'netd'\n[[limits.fleet]]\nmean = 1\nsd = 1\nunits = 10\n"
              "measure = 'netd'\n"))
      << "twice";
}

TEST(Plan, RefusesABudgetThatIsWrong) {
  const auto refusal = [](const std::string& rows) {
    const Result<Plan> plan = parse(rows);
    return plan ? "accepted" : plan.error().message;
  };
  const std::string row = "[[uncertainty.component]]\nname = 'distance'\n";

  EXPECT_THAT(refusal(row + "value = -1\n"), HasSubstr("a number from 0 to 1e+12"));
  EXPECT_THAT(refusal(row + "value = 1\nunit = 'K'\n"), HasSubstr("found \"K\""));
  EXPECT_THAT(refusal("[[uncertainty.component]]\nname = 'focus'\nvalue = 1\nunit = 'mm'\n"),
              HasSubstr("enters acuity"));
  EXPECT_THAT(refusal(row + "value = 1\nunit = 'mm'\n" + row + "value = 1\nunit = '%'\n"),
              HasSubstr("is listed twice"));
  EXPECT_THAT(refusal("[[uncertainty.component]]\nname = 'finite trials'\nvalue = 1\n"), HasSubstr("the run itself"));
  EXPECT_THAT(refusal(row + "value = 1\ndistribution = 'rectangular'\ncoverage_factor = 2\n"),
              HasSubstr("only a normal distribution"));
}

TEST(Plan, ThatRequiresABudgetHasACompleteOne) {
  std::string complete = "[uncertainty]\nrequire = true\n";
  const Result<Plan> refused =
      parse(complete + "[[uncertainty.component]]\nname = 'distance'\nvalue = 1\nunit = 'mm'\n");
  for (const BudgetInput input : expected_inputs)
    complete += "[[uncertainty.component]]\nname = '" + std::string(to_string(input)) + "'\nvalue = 0\n";

  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("does not state entrance-pupil"));
  const Result<Plan> plan = parse(complete);
  EXPECT_TRUE(plan) << plan.error().message;
}

TEST(Plan, SeveralFramesAreForGradedAnswers) {
  const std::string two = "[schedule]\nframes_per_presentation = 2\n";
  const Result<Plan> refused = parse(two + "answers = \"binary\"\n");

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::invalid_input);
  EXPECT_THAT(refused.error().message, HasSubstr("more than one frame needs answers = \"graded\""));
  EXPECT_TRUE(parse(two + "answers = \"graded\"\n"));
  EXPECT_TRUE(parse(two)) << "graded is what answers are where nothing is said";
  // It says how many there are of graded answers, where there are any.
  EXPECT_EQ(chosen_answers(parse(two + "[fit]\nestimator = \"weibull\"\n").value(), {}).frames, 1);
}

TEST(Plan, FramesAreOfEveryContrastOrOneNumberForEach) {
  const auto with = [](const std::string& frames) {
    return parse("[target]\ndistance_m = 2\ndelta_t_k = [16.9, 0.23]\n[schedule]\nframes_per_presentation = " + frames +
                 "\n");
  };
  const Result<Plan> each = with("[1, 12]"), one = with("3"), open = with("[2, 0]");

  ASSERT_TRUE(each && one && open);
  EXPECT_EQ(frames_at(*each, 16.9), 1);
  EXPECT_EQ(chosen_answers(*each, {}, 0.23).frames, 12);
  EXPECT_EQ(frames_at(*each, 1.93), 0) << "not among its contrasts";
  EXPECT_EQ(frames_at(*one, 0.23), 3);
  EXPECT_EQ(chosen_answers(*open, {}, 0.23).frames, 4);
  for (const Result<Plan>& plan : {each, one, open}) EXPECT_EQ(parse(to_toml(*plan)), *plan);
  EXPECT_THAT(to_toml(*one), HasSubstr("frames_per_presentation = 3\n"));
  for (const char* wrong : {"[1, 2, 3]", "[]", "[1, -1]", "[1, 2.5]", "[1, 1001]", "1.5", "[1, [2]]", "'2'"})
    EXPECT_FALSE(with(wrong)) << wrong;
  EXPECT_FALSE(parse("[schedule]\nanswers = 'binary'\nframes_per_presentation = [1, 1, 2]\n"));
}

TEST(Plan, GradedAnswersAreNotFittedWithAWeibullFunction) {
  const std::string graded = "[schedule]\nanswers = \"graded\"\n";
  const Result<Plan> refused = parse(graded + "[fit]\nestimator = \"weibull\"\n");

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::invalid_input);
  EXPECT_THAT(refused.error().message, HasSubstr("answers = \"graded\" needs \"twin-shape\""));
  EXPECT_TRUE(parse(graded));
  EXPECT_TRUE(parse(graded + "[fit]\nestimator = \"twin-shape\"\n"));
  EXPECT_FALSE(parse(graded + "[fit]\nlapse = 0.01\n"));
  EXPECT_FALSE(parse(graded + "[[module]]\nplace = \"picture\"\ncommand = \"x\"\n"));
}

TEST(Plan, WithoutAnEstimatorTakesTheFunctionOfTheTwinWhereThereIsOne) {
  const auto chosen = [](const std::string& text, const SensorSpec& sensor) {
    return chosen_estimator(parse(text).value(), sensor);
  };
  const SensorSpec sensor;
  SensorSpec behind_module;
  behind_module.modules.emplace_back();
  const std::string module = "[[module]]\nplace = \"picture\"\ncommand = \"x\"\n";
  for (const char* text : {"", "[fit]\nestimator = \"automatic\"\n", "[fit]\nlapse = \"free\"\n"}) {
    EXPECT_EQ(chosen(text, sensor).estimator, FitEstimator::twin_shape) << text;
    EXPECT_EQ(chosen(text, sensor).reason, EstimatorReason::twin) << text;
  }
  EXPECT_EQ(chosen("", behind_module).estimator, FitEstimator::weibull);
  EXPECT_EQ(chosen(module, sensor).estimator, FitEstimator::weibull);
  EXPECT_EQ(chosen(module, sensor).reason, EstimatorReason::modules);
  EXPECT_EQ(chosen("[fit]\nestimator = \"weibull\"\n", sensor).estimator, FitEstimator::weibull);
  EXPECT_EQ(chosen("[fit]\nestimator = \"twin-shape\"\nlapse = 0.02\n", sensor).estimator, FitEstimator::twin_shape);
  EXPECT_EQ(chosen("[fit]\nestimator = \"weibull\"\n", sensor).reason, EstimatorReason::plan);
  EXPECT_FALSE(parse("[fit]\nestimator = \"twin-shape\"\n" + module));
}

TEST(Plan, WithoutAnswersTakesGradedOnesWhereTheirIntervalsAreProven) {
  const auto chosen = [](const std::string& text, const SensorSpec& sensor = {}) {
    const auto plan = parse(text);
    EXPECT_TRUE(plan) << text << (plan ? "" : plan.error().message);
    return plan ? chosen_answers(*plan, sensor) : AnswersTaken{};
  };
  const auto binary = [](AnswersReason reason) { return AnswersTaken{AnswerKind::binary, 1, reason}; };
  SensorSpec behind_module;
  behind_module.modules.emplace_back();
  const std::string schedule = "[schedule]\n", automatic = schedule + "answers = \"automatic\"\n";
  for (const std::string& text : {std::string(), automatic, automatic + "frames_per_presentation = 0\n"})
    EXPECT_EQ(chosen(text), (AnswersTaken{AnswerKind::graded, 4, AnswersReason::twin})) << text;
  EXPECT_EQ(chosen(schedule + "frames_per_presentation = 1\n"),
            (AnswersTaken{AnswerKind::graded, 1, AnswersReason::twin}));
  EXPECT_EQ(chosen(schedule + "answers = \"graded\"\nframes_per_presentation = 7\n"),
            (AnswersTaken{AnswerKind::graded, 7, AnswersReason::plan}));
  EXPECT_EQ(chosen(schedule + "answers = \"binary\"\n"), binary(AnswersReason::plan));
  EXPECT_EQ(chosen("[fit]\nestimator = \"weibull\"\n"), binary(AnswersReason::weibull));
  EXPECT_EQ(chosen("", behind_module), binary(AnswersReason::weibull));
  EXPECT_EQ(chosen("[[module]]\nplace = \"picture\"\ncommand = \"x\"\n"), binary(AnswersReason::weibull));
  EXPECT_EQ(chosen("[fit]\nlapse = 0.02\n"), binary(AnswersReason::lapse));
  EXPECT_EQ(chosen("[fit]\nlapse = \"free\"\n"), binary(AnswersReason::lapse));
  EXPECT_EQ(chosen("[camera]\nid = \"sim:sc2000\"\nifov_mrad = 1\ncontrast = \"grey-levels\"\n"),
            binary(AnswersReason::grey_levels));
  EXPECT_EQ(chosen(schedule + "kind = \"adaptive\"\n").kind, AnswerKind::graded);
  EXPECT_EQ(chosen(schedule + "kind = \"adaptive\"\nmax_presentations = 23\n"),
            binary(AnswersReason::few_presentations))
      << "of three contrasts";
  const std::string one_plate = "[target]\ndistance_m = 2\nplates = [\"tcat-a\"]\nmountings = [\"identity\"]\n";
  EXPECT_EQ(chosen(one_plate + "phases = 7\n"), binary(AnswersReason::few_presentations));
  EXPECT_EQ(chosen(one_plate + "phases = 8\n").kind, AnswerKind::graded);
  EXPECT_EQ(chosen(one_plate + "phases = 8\n[simulation]\nphases = 7\n").kind, AnswerKind::binary)
      << "camera and twin have the same";
  const std::string six_set_ups =
      "[target]\ndistance_m = 2\nphases = 1\nmax_contrast_lag_s = 0\n"
      "mountings = [\"identity\", \"rotated_180\", \"mirrored_horizontally\"]\n";
  EXPECT_EQ(chosen(six_set_ups).kind, AnswerKind::binary);
  EXPECT_EQ(
      chosen(six_set_ups + schedule + "kind = \"ramp\"\nramp_k_per_s = 1\nfrom_delta_t_k = 16.9\nto_delta_t_k = 0.23\n")
          .kind,
      AnswerKind::graded)
      << "presentations follow from the rate";
}

TEST(Plan, AnEmptyFileIsThePlanOfDefaults) {
  const Result<Plan> plan = parse("");

  ASSERT_TRUE(plan) << plan.error().message;
  EXPECT_EQ(*plan, Plan{});
}

TEST(Plan, TheShippedDemonstrationReadsAndShowsTheThreeContrastsOnBothPlates) {
  const Result<Plan> plan = load_plan("demo");

  ASSERT_TRUE(plan) << plan.error().message;
  EXPECT_THAT(plan->target.delta_t_k, ElementsAre(16.9, 1.93, 0.23));
  EXPECT_THAT(plan->target.plates, ElementsAre("tcat-a", "tcat-b"));
  EXPECT_EQ(plan->target.mountings.size(), 4u);
  EXPECT_EQ(parse(to_toml(*plan)).value(), *plan);
}

TEST(Plan, TheTwinShowsAsManyPhasesAsTheTargetUnlessToldOtherwise) {
  EXPECT_EQ(parse("[target]\ndistance_m = 2\nphases = 5\n").value().simulation.phases, 5);
  EXPECT_EQ(parse("[target]\ndistance_m = 2\nphases = 5\n[simulation]\nphases = 50\n").value().simulation.phases, 50);
}

struct Mistake {
  const char* name;
  const char* toml;
  const char* message;
};

void PrintTo(const Mistake& mistake, std::ostream* out) {
  *out << mistake.name;
}

class PlanMistake : public ::testing::TestWithParam<Mistake> {};

TEST_P(PlanMistake, IsRefusedInOneLineWithFileLineAndKey) {
  const Result<Plan> plan = parse(GetParam().toml);

  ASSERT_FALSE(plan);
  EXPECT_EQ(plan.error().code, ErrorCode::invalid_input);
  EXPECT_THAT(plan.error().message, HasSubstr(GetParam().message));
  EXPECT_THAT(plan.error().message, Not(HasSubstr("\n")));
}

INSTANTIATE_TEST_SUITE_P(
    All, PlanMistake,
    ::testing::Values(
        Mistake{"misspelt_key", "[target]\ndistance_m = 2\nphasse = 3\n",
                "plan.toml:3: unknown key 'phasse' in [target], did you mean 'phases'?"},
        Mistake{"no_distance", "\n[target]\nphases = 3\n", "plan.toml:2: missing key 'distance_m' in [target]"},
        Mistake{"negative_distance", "[target]\ndistance_m = -1\n",
                "plan.toml:2: key 'distance_m' in [target]: expected a number from 0.01 to 10000"},
        Mistake{"zero_contrast", "[target]\ndistance_m = 2\ndelta_t_k = [1,\n0]\n",
                "plan.toml:4: key 'delta_t_k' in [target]: a contrast of 0 K"},
        Mistake{"contrast_twice", "[target]\ndistance_m = 2\ndelta_t_k = [16.9, 16.95]\n",
                "plan.toml:3: key 'delta_t_k' in [target]: 16.95 K is listed twice"},
        Mistake{"no_contrast", "[target]\ndistance_m = 2\ndelta_t_k = []\n",
                "plan.toml:3: key 'delta_t_k' in [target]: expected at least one"},
        Mistake{"unknown_mounting", "[target]\ndistance_m = 2\nmountings = [\"identiti\"]\n",
                "did you mean 'identity'?"},
        Mistake{"mounting_twice", "[target]\ndistance_m = 2\nmountings = [\"identity\", \"identity\"]\n",
                "plan.toml:3: key 'mountings' in [target]: 'identity' is listed twice"},
        Mistake{"unknown_plate", "[target]\ndistance_m = 2\nplates = [\"tcat-x\"]\n",
                "plan.toml:3: key 'plates' in [target]: unknown plate 'tcat-x', did you mean 'tcat-a'?"},
        Mistake{"plate_twice", "[target]\ndistance_m = 2\nplates = [\"tcat-a\", \"tcat-a\"]\n",
                "'tcat-a' is listed twice"},
        Mistake{"missing_plate_file", "[target]\ndistance_m = 2\nplates = [\"./none.toml\"]\n",
                "none.toml: no such file"},
        Mistake{"unknown_kind", "[target]\ndistance_m = 2\nkind = \"scipi\"\n", "did you mean 'scpi'?"},
        Mistake{"scpi_without_address", "[target]\ndistance_m = 2\nkind = \"scpi\"\n",
                "key 'black_body' in [target]: needed for kind \"scpi\""},
        Mistake{"address_without_port", "[target]\ndistance_m = 2\nblack_body = \"10.0.0.7\"\n",
                "plan.toml:3: key 'black_body' in [target]: expected \"HOST:PORT\""},
        Mistake{"port_out_of_range", "[target]\ndistance_m = 2\nstage = \"host:70000\"\n",
                "plan.toml:3: key 'stage' in [target]: expected \"HOST:PORT\""},
        Mistake{"no_phases", "[target]\ndistance_m = 2\nphases = 0\n",
                "plan.toml:3: key 'phases' in [target]: expected a whole number"},
        Mistake{"camera_without_ifov", "[camera]\nid = \"gige:A-1\"\n",
                "plan.toml:1: missing key 'ifov_mrad' in [camera]"},
        Mistake{"camera_of_unknown_scheme", "[camera]\nid = \"gigee:A-1\"\nifov_mrad = 1\n",
                "plan.toml:2: key 'id' in [camera]: unknown scheme \"gigee\", expected one of 'gige', 'u3v', 'v4l2', "
                "'usb', 'file', 'sim', did you mean 'gige'?"},
        Mistake{"camera_without_scheme", "[camera]\nid = \"A-1\"\nifov_mrad = 1\n",
                "plan.toml:2: key 'id' in [camera]: expected SCHEME:NAME"},
        Mistake{"list_as_setting", "[camera.settings]\nA = [1]\n",
                "plan.toml:2: key 'A' in [camera]: expected a text, a number"},
        Mistake{"unknown_observer", "[observer]\nname = \"hvs1\"\n",
                "plan.toml:2: key 'name' in [observer]: unknown observer 'hvs1', did you mean 'hvs-1'?"},
        Mistake{"unknown_sensor", "[simulation]\nsensor = \"sc200\"\n",
                "plan.toml:2: key 'sensor' in [simulation]: unknown sensor 'sc200', did you mean 'sc2000'?"},
        Mistake{"unknown_effect", "[simulation]\nskip = [\"difraction\"]\n", "did you mean 'diffraction'?"},
        Mistake{"skipped_and_forced", "[simulation]\nskip = [\"detector\"]\nforce = [\"detector\"]\n",
                "plan.toml:3: key 'force' in [simulation]: 'detector' is also in skip"},
        Mistake{"unknown_accuracy", "[simulation]\naccuracy = \"good\"\n",
                "plan.toml:2: key 'accuracy' in [simulation]: expected one of 'draft', 'normal', 'reference'"},
        Mistake{"no_tolerance", "[simulation]\ntolerance_percent = 0\n", "expected a number above 0 up to 50, found 0"},
        Mistake{"lapse", "[fit]\nlapse = 0.2\n",
                "plan.toml:2: key 'lapse' in [fit]: expected a number from 0 to 0.1 or \"free\", found 0.2"},
        Mistake{"ramp_without_rate",
                "[schedule]\nkind = \"ramp\"\nfrom_delta_t_k = 16.9\nto_delta_t_k = 0.23\n[target]\ndistance_m = "
                "2\nmax_contrast_lag_s = 0.03\n",
                "key 'ramp_k_per_s' in [schedule]: needed for [schedule] kind \"ramp\", expected a rate above 0 K/s"},
        Mistake{"ramp_of_rate_0",
                "[schedule]\nkind = \"ramp\"\nramp_k_per_s = 0\nfrom_delta_t_k = 16.9\nto_delta_t_k = "
                "0.23\n[target]\ndistance_m = 2\nmax_contrast_lag_s = 0.03\n",
                "a rate of 0 K/s never leaves from_delta_t_k"},
        Mistake{"ramp_of_wrong_sign",
                "[schedule]\nkind = \"ramp\"\nramp_k_per_s = -0.5\nfrom_delta_t_k = 16.9\nto_delta_t_k = "
                "0.23\n[target]\ndistance_m = 2\nmax_contrast_lag_s = 0.03\n",
                "a rate of -0.5 K/s has the wrong sign"},
        Mistake{"ramp_that_rises",
                "[schedule]\nkind = \"ramp\"\nramp_k_per_s = 0.5\nfrom_delta_t_k = 0.23\nto_delta_t_k = "
                "16.9\n[target]\ndistance_m = 2\nmax_contrast_lag_s = 0.03\n",
                "a ramp falls towards 0 without reaching it, but the plan states 0.23 K to 16.9 K"},
        Mistake{"ramp_through_0",
                "[schedule]\nkind = \"ramp\"\nramp_k_per_s = 0.5\nfrom_delta_t_k = 16.9\nto_delta_t_k = "
                "-0.23\n[target]\ndistance_m = 2\nmax_contrast_lag_s = 0.03\n",
                "a ramp falls towards 0 without reaching it"},
        Mistake{"ramp_beside_contrasts",
                "[schedule]\nkind = \"ramp\"\nramp_k_per_s = 0.5\nfrom_delta_t_k = 16.9\nto_delta_t_k = "
                "0.5\n[target]\ndistance_m = 2\nmax_contrast_lag_s = 0.03\n",
                "the contrast 0.23 K of [target] delta_t_k is outside the ramp, 16.9 K to 0.5 K"},
        Mistake{"ramp_without_lag",
                "[schedule]\nkind = \"ramp\"\nramp_k_per_s = 0.5\nfrom_delta_t_k = 16.9\nto_delta_t_k = "
                "0.23\n[target]\ndistance_m = 2\n",
                "key 'max_contrast_lag_s' in [target]: needed for [schedule] kind \"ramp\""},
        Mistake{"ramp_of_four_set_ups",
                "[schedule]\nkind = \"ramp\"\nramp_k_per_s = 0.5\nfrom_delta_t_k = 16.9\nto_delta_t_k = "
                "0.23\n[target]\ndistance_m = 2\nmax_contrast_lag_s = 0.03\nplates = [\"tcat-a\"]\n",
                "a ramp needs at least five set-ups (plates in their mountings), found 4"},
        Mistake{"ramp_of_binary_answers",
                "[schedule]\nkind = \"ramp\"\nanswers = \"binary\"\nramp_k_per_s = 0.5\nfrom_delta_t_k = "
                "16.9\nto_delta_t_k = 0.23\n[target]\ndistance_m = 2\nmax_contrast_lag_s = 0.03\n",
                "a ramp needs graded answers that are fitted with the function of the twin"},
        Mistake{"ramp_by_hand",
                "[schedule]\nkind = \"ramp\"\nramp_k_per_s = 0.5\nfrom_delta_t_k = 16.9\nto_delta_t_k = "
                "0.23\n[target]\ndistance_m = 2\nmax_contrast_lag_s = 0.03\nkind = \"prompt\"\n",
                "a ramp needs [target] kind \"scpi\" or \"scene\""},
        Mistake{"band_of_adaptive",
                "[schedule]\nkind = \"adaptive\"\n[target]\ndistance_m = 2\ncontrast_settling_band_percent = 10\n",
                "a contrast of each presentation needs [schedule] kind \"constant\" or \"ramp\""},
        Mistake{"limit_without_contrast", "[[limits.acuity]]\ndelta_t_k = 5\nleast_acuity_per_mrad = 1\n",
                "plan.toml:2: key 'delta_t_k' in [limits.acuity]: 5 K is not among the contrasts of [target]"},
        Mistake{"limit_twice",
                "[[limits.acuity]]\ndelta_t_k = 16.9\nleast_acuity_per_mrad = 1\n[[limits.acuity]]\ndelta_t_k = "
                "16.9\nleast_acuity_per_mrad = 2\n",
                "plan.toml:5: key 'delta_t_k' in [limits.acuity]: a second limit at 16.9 K"},
        Mistake{"share", "[measurement]\nmax_rejected_share = 5\n",
                "plan.toml:2: key 'max_rejected_share' in [measurement]: expected a number from 0 to 1, found 5"},
        Mistake{"seed", "seed = -1\n", "plan.toml:1: key 'seed': expected a whole number of 0 or more, found -1"},
        Mistake{"date", "[[instrument]]\nname = \"x\"\ncalibration_due = \"2027-02-29\"\n",
                "plan.toml:3: key 'calibration_due' in [instrument]: expected a date"}),
    [](const auto& row) { return std::string(row.param.name); });

TEST(Plan, FilesNamedInAPlanAreRelativeToThePlan) {
  const testing::TemporaryFolder folder;
  folder.write("parts/mine.toml", testing::content_of(source_file("sim_devices/sensors/sc2000.toml")));
  const std::filesystem::path file = folder.write("plan.toml", "[simulation]\nsensor = \"parts/mine.toml\"\n");

  const Result<LoadedPlan> loaded = read_plan(file.string());

  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_EQ(loaded->plan().simulation.sensor, (folder.path() / "parts/mine.toml").string());
  EXPECT_EQ(loaded->sensor().name, "sc2000");
}

TEST(Plan, TheMicroscanOfTheSensorHoldsUnlessThePlanSaysOtherwise) {
  const testing::TemporaryFolder folder;
  std::string sensor = testing::content_of(source_file("sim_devices/sensors/sc2000.toml"));
  sensor.replace(sensor.find("microscan = 1"), 13, "microscan = 2");
  folder.write("scan.toml", sensor);
  const std::string plan = "[simulation]\nsensor = \"./scan.toml\"\n";

  EXPECT_EQ(load_plan(folder.write("a.toml", plan).string()).value().simulation.microscan, 2);
  EXPECT_EQ(load_plan(folder.write("b.toml", plan + "microscan = 1\n").string()).value().simulation.microscan, 1);
}

TEST(Plan, AMissingFileIsOneSentence) {
  const Result<Plan> plan = load_plan("./there-is-no-such-plan.toml");

  ASSERT_FALSE(plan);
  EXPECT_EQ(plan.error().message, "./there-is-no-such-plan.toml: no such file");
}

TEST(Plan, AnInstrumentIsOverdueFromTheDayAfterItsDueDate) {
  using namespace std::chrono_literals;
  const Plan plan = unusual_plan();

  EXPECT_TRUE(check_calibration(plan, 2027y / 2 / 28));
  const Result<void> overdue = check_calibration(plan, 2027y / 3 / 1);

  ASSERT_FALSE(overdue);
  EXPECT_EQ(overdue.error().code, ErrorCode::calibration);
  EXPECT_EQ(overdue.error().message, "calibration overdue: black body BB-1 (due 2027-02-28)");
}

TEST(PlanOptions, ReachThePartsThatUseThem) {
  const Plan plan = unusual_plan();
  const std::vector<TargetPlate> plates = LoadedPlan::load(plan).value().plates();

  const MeasurementOptions measurement = measurement_options(plan, plates, 1.5);
  const ConstantStimuliOptions measured = stimuli_options(plan, plates, 1.5, Side::measured);
  const ConstantStimuliOptions simulated = stimuli_options(plan, plates, 1.5, Side::simulated);

  EXPECT_EQ(measurement.distance_m, 2.0625);
  EXPECT_EQ(measurement.nuc_interval_s, 120);
  EXPECT_EQ(measurement.frame_timeout, std::chrono::milliseconds(500));
  EXPECT_EQ(measurement.integrity.max_saturated_share, 0.125);
  EXPECT_EQ(measurement.registration.max_residual_px, 0.5);
  EXPECT_EQ(measurement.seed, 9223372036854775807u);
  EXPECT_THAT(measured.plates, ElementsAre("tcat-b"));
  EXPECT_DOUBLE_EQ(measured.pixel_mm, 1.5 * 2.0625);
  EXPECT_EQ(measured.phases, 7);
  EXPECT_EQ(simulated.phases, 64);
  EXPECT_THAT(measured.change_cost_s, ElementsAre(1, 2, 3, 0));
  EXPECT_EQ(fit_options(plan).fixed_lapse, std::nullopt);
  EXPECT_EQ(comparison_options(plan).margin_percent, 12.5);
  EXPECT_EQ(accuracy_of(plan).value().acuity_tolerance_percent, 2.5);
  EXPECT_EQ(LoadedPlan::load(plan).value().sensor().microscan, 2);
}

TEST(PlanOptions, TwoPlatesOfOneNameAreRefused) {
  const testing::TemporaryFolder folder;
  Plan plan;
  plan.target.plates = {"tcat-a",
                        folder.write("copy.toml", testing::content_of(source_file("tod/plate/tcat-a.toml"))).string()};

  const auto loaded = LoadedPlan::load(plan);

  ASSERT_FALSE(loaded);
  EXPECT_THAT(loaded.error().message, HasSubstr("a second plate with the name 'tcat-a'"));
}

TEST(Plan, AsksForConstantStimuliUnlessItsScheduleIsAdaptive) {
  const auto silent = parse("[target]\ndistance_m = 2\n");
  const auto adaptive = parse(
      "[target]\ndistance_m = 2\n[schedule]\nkind = \"adaptive\"\nhalf_width_percent = 5\nmax_presentations = 64\n");

  ASSERT_TRUE(silent) << silent.error().message;
  ASSERT_TRUE(adaptive) << adaptive.error().message;
  EXPECT_EQ(silent->schedule.kind, ScheduleKind::constant);
  EXPECT_EQ(adaptive->schedule.kind, ScheduleKind::adaptive);
  EXPECT_EQ(adaptive->schedule.half_width_percent, 5);
  EXPECT_EQ(adaptive->schedule.max_presentations, 64);
}

TEST(Plan, RefusesAScheduleThatIsUnknownOrCanShowNothing) {
  for (const char* text : {"kind = \"staircase\"", "half_width_percent = 0", "max_presentations = 0", "trials = 5"}) {
    const auto plan = parse("[target]\ndistance_m = 2\n[schedule]\n" + std::string(text) + "\n");

    ASSERT_FALSE(plan) << text;
    EXPECT_EQ(plan.error().code, ErrorCode::invalid_input);
  }
}

}  // namespace
}  // namespace todbench
