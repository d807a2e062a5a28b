// SPDX-License-Identifier: GPL-3.0-or-later
// Plan keys of observer, simulated twin, schedule, fit and measurement.
#include "bench/plan/plan_sections.h"

#include "bench/plan/key_places.h"
#include "bench/plan/run_checks.h"

namespace todbench {

namespace {

constexpr std::string_view right_and_down = "two numbers, right and down";

}  // namespace

PlanSection observer_section() {
  return {.name = "observer",
          .sentence = "The observer, which judges the pictures of the camera and of its twin.",
          .keys = {{.name = "name",
                    .type = ResourceKey{ResourceKind::observer},
                    .sentence = "Observer, by name or file",
                    .place = in_plan(&Plan::observer),
                    .form = {"Observer", "planObserver"},
                    .option = {"--observer"}}}};
}

PlanSection simulation_section() {
  const auto of = [](auto member) { return in(&Plan::simulation, member); };
  const auto effects = [](MayBeEmpty may_be_empty) {
    return ChoicesKey{names_of(all_effects), "effect", may_be_empty};
  };
  return {.name = "simulation",
          .sentence = "The simulated sensor, alone or as the twin of the camera.",
          .keys = {
              {.name = "sensor",
               .type = ResourceKey{ResourceKind::sensor},
               .sentence = "Simulated sensor, by name or file",
               .place = of(&SimulationPlan::sensor),
               .form = {"Simulated sensor", "planSensor"},
               .option = {"--sensor"}},
              {.name = "accuracy",
               .type = ChoiceKey{{"draft", "normal", "reference", "auto"}},
               .sentence = "Numerical accuracy of the simulation ('auto' derives it from tolerance_percent)",
               .place = of(&SimulationPlan::accuracy),
               .form = {"Accuracy", "planAccuracy"},
               .option = {"--accuracy"}},
              {.name = "tolerance_percent",
               .type = NumberKey{NumberRange::above_to(0, 50)},
               .unit = "%",
               .sentence = "Largest acceptable numerical error of the 75 % acuity",
               .place = of(&SimulationPlan::tolerance_percent),
               .option = {"--tolerance-percent"}},
              {.name = "microscan",
               .type = WholeKey{1, 4},
               .sentence = "Samples per detector pitch and axis",
               .place = of(&SimulationPlan::microscan),
               .fallback = {"value of the sensor",
                            [](const Plan&, const PlanParts& parts) { return to_key_value(parts.sensor.microscan); }},
               .option = {"--microscan"}},
              {.name = "phases",
               .type = WholeKey{1, 100000},
               .sentence = "Sub-pixel shifts of the twin per plate, mounting and contrast",
               .place = of(&SimulationPlan::phases),
               .fallback = {"`phases` of [target]",
                            [](const Plan& plan, const PlanParts&) { return to_key_value(plan.target.phases); }}},
              {.name = "motion_mrad_s",
               .type = NumbersKey{NumberRange::between(-1e4, 1e4), right_and_down, 2},
               .unit = "mrad/s",
               .sentence = "Motion of the target. It has an effect if the sensor has a time constant",
               .place = of(&SimulationPlan::motion)},
              {.name = "skip",
               .type = effects(MayBeEmpty::yes),
               .sentence = "Effects to skip, regardless of the planner",
               .place = of(&SimulationPlan::skip),
               .option = {"--skip"}},
              {.name = "force",
               .type = effects(MayBeEmpty::yes),
               .sentence = "Effects to simulate, even if they are neutral",
               .place = of(&SimulationPlan::force),
               .option = {"--force"},
               .check = check_force},
              {.name = "paired",
               .type = FlagKey{},
               .sentence = "With graded answers, the twin is also shown the presentations of the camera, and the "
                           "paired ratio decides",
               .place = of(&SimulationPlan::paired)},
          }};
}

PlanSection schedule_section() {
  const auto of = [](auto member) { return in(&Plan::schedule, member); };
  return {
      .name = "schedule",
      .sentence = "Choice of the presentations, for camera and twin.",
      .keys = {
          {.name = "kind",
           .type = ChoiceKey{names_of(all_schedule_kinds)},
           .sentence = "Every combination of [target] (constant), presentations chosen from the answers so far "
                       "(adaptive), or a "
                       "contrast that falls and rises while the plate is shifted (ramp)",
           .place = of(&SchedulePlan::kind),
           .form = {"Schedule", "planSchedule"},
           .check = check_schedule_kind},
          {.name = "half_width_percent",
           .type = NumberKey{NumberRange::above_to(0, 100)},
           .unit = "%",
           .sentence = "Adaptive schedule: wanted half-width of the 95 % interval of S75",
           .place = of(&SchedulePlan::half_width_percent),
           .form = {"Adaptive: half-width", "planHalfWidth"}},
          {.name = "max_presentations",
           .type = WholeKey{1, 1000000},
           .sentence = "Adaptive schedule: largest number of presentations, over all contrasts",
           .place = of(&SchedulePlan::max_presentations)},
          {.name = "ramp_k_per_s",
           .type = OptionalNumberKey{NumberRange::between(-500, 500)},
           .unit = "K/s",
           .sentence = "Ramp: rate at from_delta_t_k, above 0. It falls in proportion to the contrast. Required for a "
                       "ramp",
           .place = of(&SchedulePlan::ramp_k_per_s),
           .check = check_ramp_rate},
          {.name = "from_delta_t_k",
           .type = OptionalNumberKey{NumberRange::between(-500, 500)},
           .unit = "K",
           .sentence = "Ramp: contrast at which every set-up begins and ends. Required for a ramp",
           .place = of(&SchedulePlan::from_delta_t_k),
           .check = check_ramp_from},
          {.name = "to_delta_t_k",
           .type = OptionalNumberKey{NumberRange::between(-500, 500)},
           .unit = "K",
           .sentence = "Ramp: contrast at which it turns, nearer to 0. Required for a ramp",
           .place = of(&SchedulePlan::to_delta_t_k),
           .check = check_ramp_to},
          {.name = "answers",
           .type = ChoiceKey{names_of(all_answers_choices)},
           .sentence =
               "Right or wrong (binary), or the probability of the right answer for the observed picture (graded). "
               "With 'automatic', answers are graded if the function of the twin is fitted and the plan allows it",
           .place = of(&SchedulePlan::answers)},
          {.name = "frames_per_presentation",
           .type = WholesKey{{0, 1000}},
           .sentence = "Successive good frames that a graded answer averages: one number, or one for each contrast of "
                       "delta_t_k; 0: chosen by the program (method/measurement.md)",
           .place = of(&SchedulePlan::frames_per_presentation),
           .check = check_frames_per_presentation}}};
}

PlanSection fit_section() {
  return {
      .name = "fit",
      .sentence = "The psychometric function that is fitted to the answers.",
      .keys = {{.name = "form",
                .type = ChoiceKey{names_of(all_psychometric_forms)},
                .sentence = "Variable of the Weibull function: size or acuity",
                .place = in(&Plan::fit, &FitPlan::form)},
               {.name = "lapse",
                .type = NumberOrWordKey{NumberRange::between(0, 0.1), "free"},
                .sentence = "Lapse rate: the share of wrong answers to clearly visible triangles, or 'free' to fit it",
                .place = in(&Plan::fit, &FitPlan::lapse)},
               {.name = "estimator",
                .type = ChoiceKey{names_of(all_estimator_choices)},
                .sentence = "Fitted function: a Weibull function of this form, or the function of the simulated twin, "
                            "stretched in size. 'automatic' takes the function of the twin if there is one",
                .place = in(&Plan::fit, &FitPlan::estimator),
                .check = check_estimator}}};
}

PlanSection measurement_section() {
  const auto of = [](auto member) { return in(&Plan::measurement, member); };
  return {
      .name = "measurement",
      .sentence = "How frames are taken, and when they are rejected.",
      .keys = {
          {.name = "registration_frames",
           .type = WholeKey{1, 10000},
           .sentence = "Frames averaged to locate the plate, once per plate and mounting",
           .place = of(&MeasurementPlan::registration_frames)},
          {.name = "contrast_frames",
           .type = WholeKey{1, 10000},
           .sentence = "Frames averaged for the effective contrast, once per plate, mounting and contrast",
           .place = of(&MeasurementPlan::contrast_frames)},
          {.name = "min_reference_px",
           .type = NumberKey{NumberRange::between(0.1, 1e4)},
           .unit = "px",
           .sentence = "Size of the smallest triangles that measure the effective contrast",
           .place = of(&MeasurementPlan::min_reference_px)},
          {.name = "frames_after_change",
           .type = WholeKey{0, 10000},
           .sentence = "Exposures discarded after the target moved",
           .place = of(&MeasurementPlan::frames_after_change)},
          {.name = "max_rejected_share",
           .type = NumberKey{share},
           .sentence = "Largest share of rejected frames. Beyond it, after 100 frames, the run ends",
           .place = of(&MeasurementPlan::max_rejected_share)},
          {.name = "max_saturated_share",
           .type = NumberKey{share},
           .sentence = "Largest share of saturated pixels in a frame that is measured",
           .place = of(&MeasurementPlan::max_saturated_share)},
          {.name = "frame_timeout_ms",
           .type = WholeKey{1, 600000},
           .unit = "ms",
           .sentence = "Longest wait for a frame. After it the camera counts as lost",
           .place = of(&MeasurementPlan::frame_timeout_ms)},
          {.name = "max_scale_deviation",
           .type = NumberKey{NumberRange::above_to(0, 0.5)},
           .sentence = "Largest relative deviation of the magnification from the one expected from distance and IFOV",
           .place = of(&MeasurementPlan::max_scale_deviation)},
          {.name = "max_rotation_deg",
           .type = NumberKey{NumberRange::above_to(0, 45)},
           .unit = "deg",
           .sentence = "Largest rotation of the plate",
           .place = of(&MeasurementPlan::max_rotation_deg)},
          {.name = "max_residual_px",
           .type = NumberKey{NumberRange::above_to(0, 5)},
           .unit = "px",
           .sentence = "Largest rms distance of the triangles from their expected places",
           .place = of(&MeasurementPlan::max_residual_px)},
          {.name = "max_readback_deviation_k",
           .type = NumberKey{NumberRange::between(1e-6, 20)},
           .unit = "K",
           .sentence = "Largest difference between the contrast that the target reads back and the set contrast. A "
                       "larger one gives a note",
           .place = of(&MeasurementPlan::max_readback_deviation_k)},
          {.name = "record_frames",
           .type = FlagKey{},
           .sentence = "Keep every frame in the session, for todbench replay",
           .place = of(&MeasurementPlan::record_frames),
           .form = {"Keep frames for replay", "planRecord"},
           .option = {"--record-frames", OptionOf::measurements}},
      }};
}

}  // namespace todbench
