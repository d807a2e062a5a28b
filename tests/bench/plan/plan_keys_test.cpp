// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/plan/plan_keys.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "bench/plan/plan_options.h"
#include "bench/text/unit_hint.h"
#include "sim_devices/sensor/sensor_key.h"
#include "tests/support/source_file.h"
#include "tests/support/temporary_folder.h"

namespace todbench {
namespace {

using ::testing::HasSubstr;

/// Every key of the table, repeated sections with one row.
std::vector<KeyAt> all_keys() {
  std::vector<KeyAt> keys;
  for (const PlanSection& section : plan_sections()) {
    for (const PlanKey& key : section.keys) keys.push_back({&section, &key, 0});
  }
  return keys;
}

/// The defaults, with one row in every repeated section.
Plan with_rows() {
  Plan plan;
  for (const PlanSection& section : plan_sections()) {
    if (section.repeated()) section.rows.resize(plan, 1);
  }
  return plan;
}

TEST(PlanKeys, HaveTheDefaultsOfThePlansStructsAndNoOthers) {
  Plan plan = with_rows();

  for (const KeyAt& at : all_keys()) at.key->place.set(plan, 0, default_of(at));

  EXPECT_EQ(plan, with_rows());
  EXPECT_EQ(parse_plan({"plan.toml", ""}, "").value(), Plan{});
}

TEST(PlanKeys, DefaultsAreThoseOfThePartsThatUseThem) {
  const LoadedPlan loaded = LoadedPlan::load(Plan{}).value();
  const MeasurementOptions planned = measurement_options(loaded.plan(), loaded.plates(), 1), own;
  const ConstantStimuliOptions stimuli = stimuli_options(loaded.plan(), loaded.plates(), 1, Side::measured), shown;

  EXPECT_EQ(planned.registration_frames, own.registration_frames);
  EXPECT_EQ(planned.contrast_frames, own.contrast_frames);
  EXPECT_EQ(planned.min_reference_px, own.min_reference_px);
  EXPECT_EQ(planned.frames_after_change, own.frames_after_change);
  EXPECT_EQ(planned.nuc_interval_s, own.nuc_interval_s);
  EXPECT_EQ(planned.nuc_wait_s, own.nuc_wait_s);
  EXPECT_EQ(planned.max_rejected_share, own.max_rejected_share);
  EXPECT_EQ(planned.frame_timeout, own.frame_timeout);
  EXPECT_EQ(planned.integrity.max_saturated_share, own.integrity.max_saturated_share);
  EXPECT_EQ(planned.registration.max_scale_deviation, own.registration.max_scale_deviation);
  EXPECT_EQ(planned.registration.max_rotation_deg, own.registration.max_rotation_deg);
  EXPECT_EQ(planned.registration.max_residual_px, own.registration.max_residual_px);
  EXPECT_EQ(stimuli.phases, shown.phases);
  EXPECT_THAT(stimuli.change_cost_s, ::testing::ElementsAreArray(shown.change_cost_s));
}

TEST(PlanKeys, AreNamedOnceAndSayWhatTheyAre) {
  std::set<std::string> paths, lines, options;
  for (const KeyAt& at : all_keys()) {
    const std::string path = path_of(*at.section, *at.key);
    EXPECT_TRUE(paths.insert(path).second) << path;
    EXPECT_FALSE(at.key->sentence.empty()) << path;
    EXPECT_EQ(plan_key(path).key, at.key);
    const bool own_line = at.key->form.label.empty() || lines.insert(std::string(at.key->form.object_name)).second;
    EXPECT_TRUE(own_line) << path;
    const bool own_option = at.key->option.name.empty() || options.insert(std::string(at.key->option.name)).second;
    EXPECT_TRUE(own_option) << path;
  }
}

TEST(PlanKeys, ThePageInTheDocumentsIsWhatTheTableSays) {
  EXPECT_EQ(testing::content_of(source_file("docs/reference/plan-keys.md")), plan_keys_page())
      << "write it again: plan_keys_page docs/reference/plan-keys.md";
}

TEST(PlanKeys, TextsOfFormsAndCommandLinesReadBackEqual) {
  for (const KeyAt& at : all_keys()) {
    if (std::holds_alternative<FreeTableKey>(at.key->type)) continue;
    const KeyValue value = default_of(at);
    if (at.key->required == Required::always) continue;  // the default of a row is no value of its own

    const auto back = value_from_text(at.key->type, plain_text(at.key->type, value));

    ASSERT_TRUE(back) << path_of(*at.section, *at.key) << ": " << back.error().message;
    EXPECT_TRUE(*back == value) << path_of(*at.section, *at.key);
  }
}

/// A value that no range allows; nothing for types without one.
std::optional<KeyValue> impossible(const KeyType& type) {
  const double nan = std::nan("");
  if (std::holds_alternative<NumberKey>(type) || std::holds_alternative<OptionalNumberKey>(type) ||
      std::holds_alternative<NumberOrWordKey>(type))
    return nan;
  if (std::holds_alternative<NumbersKey>(type)) return std::vector<double>{nan, 1};
  if (std::holds_alternative<WholeKey>(type)) return std::int64_t{-1};
  if (std::holds_alternative<WholesKey>(type)) return std::vector<double>{-1};
  return std::nullopt;
}

TEST(ValidPlan, NoNumberLeavesItsRangeWhoeverMadeThePlan) {
  Plan good = with_rows();
  good.limits.acuity = {{16.9, 0.4}};
  good.measures.noise = good.measures.transfer = true;
  good.limits.measures = {{"netd", std::nullopt, 0.05}};
  good.measures.pixels = true;
  good.limits.zones = {{.name = "centre", .bad_pixels = 0}};
  good.limits.fleets = {{.delta_t_k = 0.23, .mean = 0.3, .sd = 0.04, .units = 12}};
  for (ModulePlan& module : good.modules) module.command = "cat";
  ASSERT_TRUE(validate(good)) << validate(good).error().message;
  int tried = 0;
  for (const KeyAt& at : all_keys()) {
    const auto wrong = impossible(at.key->type);
    if (!wrong) continue;
    Plan plan = good;
    at.key->place.set(plan, 0, *wrong);

    const auto valid = validate(plan);

    ASSERT_FALSE(valid) << path_of(*at.section, *at.key);
    EXPECT_EQ(valid.error().code, ErrorCode::invalid_input);
    ASSERT_TRUE(valid.error().key);
    // A contrast that is no number is not among those of a limit either: the first in the table is said.
    EXPECT_EQ(valid.error().key->name, path_of(*at.section, *at.key));
    ++tried;
  }
  EXPECT_GT(tried, 30);
}

struct Contradiction {
  const char* path;
  void (*make)(Plan&);
  const char* toml;
  const char* sentence;
};

TEST(ValidPlan, IsRefusedWithTheSentenceOfAFileThatSaysTheSame) {
  const std::string target = "[target]\ndistance_m = 2\n";
  const Contradiction all[] = {
      {"target.delta_t_k",
       [](Plan& p) {
         p.target.delta_t_k = {1, 0};
       },
       "delta_t_k = [1, 0]\n", "a contrast of 0 K makes the triangles invisible"},
      {"target.plates", [](Plan& p) { p.target.plates = {}; }, "plates = []\n", "expected at least one plate"},
      {"target.mountings", [](Plan& p) { p.target.mountings = {}; }, "mountings = []\n",
       "expected at least one mounting"},
      {"target.black_body", [](Plan& p) { p.target.kind = TargetKind::scpi; }, "kind = \"scpi\"\n",
       "needed for kind \"scpi\", expected \"HOST:PORT\", \"serial:/dev/NAME\" or \"vxi11:HOST\""},
      {"simulation.accuracy", [](Plan& p) { p.simulation.accuracy = "good"; }, "[simulation]\naccuracy = \"good\"\n",
       "expected one of 'draft', 'normal', 'reference', 'auto', found \"good\""},
      {"simulation.force", [](Plan& p) { p.simulation.skip = p.simulation.force = {Effect::detector}; },
       "[simulation]\nskip = [\"detector\"]\nforce = [\"detector\"]\n", "'detector' is also in skip"},
      {"camera.id", [](Plan& p) { p.camera.id = "A-1", p.camera.ifov_mrad = 1; },
       "[camera]\nid = \"A-1\"\nifov_mrad = 1\n",
       "expected SCHEME:NAME as listed by 'todbench devices', found \"A-1\""},
      {"camera.ifov_mrad", [](Plan& p) { p.camera.id = "gige:A-1"; }, "[camera]\nid = \"gige:A-1\"\nifov_mrad = 0\n",
       "expected a number from 0.0001 to 1000, found 0"},
      {"limits.acuity.delta_t_k",
       [](Plan& p) {
         p.limits.acuity = {{5, 1}};
       },
       "[[limits.acuity]]\ndelta_t_k = 5\nleast_acuity_per_mrad = 1\n", "5 K is not among the contrasts of [target]"},
      {"instrument.calibration_due",
       [](Plan& p) {
         p.instruments = {{"x", "", "", "soon"}};
       },
       "[[instrument]]\nname = \"x\"\ncalibration_due = \"soon\"\n", "expected a date \"YYYY-MM-DD\", found \"soon\""}};
  for (const Contradiction& wrong : all) {
    Plan plan;
    wrong.make(plan);

    const auto valid = validate(plan);
    const auto read = parse_plan({"plan.toml", target + wrong.toml}, "");

    ASSERT_FALSE(valid) << wrong.path;
    ASSERT_TRUE(valid.error().key);
    EXPECT_EQ(valid.error().key->name, wrong.path);
    EXPECT_EQ(valid.error().key->reason, wrong.sentence);
    ASSERT_FALSE(read) << wrong.path;
    EXPECT_EQ(read.error().key, valid.error().key);
    EXPECT_THAT(read.error().message, HasSubstr(valid.error().message));
  }
}

// A number beyond every physical value ends as infinity or NaN somewhere. Nothing is measured beyond 1e13 of any unit.
TEST(PlanKeys, EveryNumberHasAPhysicalRange) {
  const auto range_of = [](const KeyType& type) -> std::optional<NumberRange> {
    if (const auto* number = std::get_if<NumberKey>(&type)) return number->range;
    if (const auto* number = std::get_if<OptionalNumberKey>(&type)) return number->range;
    if (const auto* number = std::get_if<NumberOrWordKey>(&type)) return number->range;
    if (const auto* numbers = std::get_if<NumbersKey>(&type)) return numbers->range;
    return std::nullopt;
  };
  int numbers = 0;
  for (const PlanSection& section : plan_sections()) {
    for (const PlanKey& key : section.keys) {
      const auto range = range_of(key.type);
      if (!range) continue;
      ++numbers;
      EXPECT_LT(std::max(std::abs(range->low), range->high), 1e13) << section.name << "." << key.name;
      for (const double wrong : {1e308, -1e308, 1e-320, std::nan(""), HUGE_VAL})
        EXPECT_FALSE(range->contains(wrong)) << section.name << "." << key.name << " = " << wrong;
    }
  }
  EXPECT_GT(numbers, 40);
  for (const SensorKey& key : sensor_keys()) {
    if (std::holds_alternative<DisplayReconstruction SensorSpec::*>(key.member)) continue;
    EXPECT_LT(std::max(std::abs(key.range.low), key.range.high), 1e13) << key.name;
  }
}

TEST(UnitHint, NamesTheUnitThatWouldBeInRange) {
  EXPECT_EQ(unit_hint("wavelength_min_um", 0.0075, NumberRange::between(0.1, 100)), "; is the value in mm?");
  EXPECT_EQ(unit_hint("wavelength_min_um", 7500, NumberRange::between(0.1, 100)), "; is the value in nm?");
  EXPECT_EQ(unit_hint("--distance-m", 2e6, NumberRange::between(0.1, 1e4)), "; is the value in mm?");
  EXPECT_EQ(unit_hint("mean", 1e20, NumberRange::between(0, 1e12)), "");
  EXPECT_EQ(unit_hint("netd_k", 1e-320, NumberRange::between(0, 100)), "; is 0 meant?");
  EXPECT_EQ(unit_hint("netd_k", 70, NumberRange::between(0, 5)), "; is the value in mK?");
  EXPECT_EQ(unit_hint("background_k", 15, NumberRange::between(100, 5000)), "; is the value in degrees Celsius?");
  EXPECT_EQ(unit_hint("room_temperature_c", 295, NumberRange::between(-100, 200)), "; is the value in kelvin?");
  EXPECT_EQ(unit_hint("pitch_um", 12, NumberRange::between(0.1, 100)), "");
}

}  // namespace
}  // namespace todbench
