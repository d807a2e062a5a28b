// Keys of observer, simulated twin, schedule, fit and measurement.
#include "bench/plan/plan_sections.h"

#include "bench/plan/key_places.h"
#include "bench/plan/plan_checks.h"

namespace todbench {

namespace {

constexpr std::string_view right_and_down = "two numbers, right and down";

}  // namespace

PlanSection observer_section() {
  return {.name = "observer",
          .sentence = "Who judges the pictures, of the camera and of its twin.",
          .keys = {{.name = "name",
                    .type = ResourceKey{ResourceKind::observer},
                    .sentence = "name or file",
                    .place = in_plan(&Plan::observer),
                    .form = {"Observer", "planObserver"},
                    .option = {"--observer"}}}};
}

PlanSection simulation_section() {
  const auto of = [](auto member) { return in(&Plan::simulation, member); };
  const auto effects = [](MayBeEmpty may_be_empty) {
    return ChoicesKey{names_of(all_effects), "effect", may_be_empty};
  };
  return {
      .name = "simulation",
      .sentence = "The simulated sensor: alone, or as the twin of the camera.",
      .keys = {
          {.name = "sensor",
           .type = ResourceKey{ResourceKind::sensor},
           .sentence = "name or file",
           .place = of(&SimulationPlan::sensor),
           .form = {"Simulated sensor", "planSensor"},
           .option = {"--sensor"}},
          {.name = "accuracy",
           .type = ChoiceKey{{"draft", "normal", "reference", "auto"}},
           .sentence = "of the images; auto: everything from tolerance_percent",
           .place = of(&SimulationPlan::accuracy),
           .form = {"Accuracy", "planAccuracy"},
           .option = {"--accuracy"}},
          {.name = "tolerance_percent",
           .type = NumberKey{NumberRange::above_to(0, 50)},
           .unit = "%",
           .sentence = "what may be wrong in the 75 % acuity",
           .place = of(&SimulationPlan::tolerance_percent),
           .option = {"--tolerance-percent"}},
          {.name = "microscan",
           .type = WholeKey{1, 4},
           .sentence = "samples per detector pitch and axis",
           .place = of(&SimulationPlan::microscan),
           .fallback = {"that of the sensor",
                        [](const Plan&, const PlanParts& parts) { return to_key_value(parts.sensor.microscan); }},
           .option = {"--microscan"}},
          {.name = "phases",
           .type = WholeKey{1, 100000},
           .sentence = "sub-pixel shifts per plate, mounting and contrast",
           .place = of(&SimulationPlan::phases),
           .fallback = {"that of [target]",
                        [](const Plan& plan, const PlanParts&) { return to_key_value(plan.target.phases); }}},
          {.name = "motion_mrad_s",
           .type = NumbersKey{NumberRange::between(-1e4, 1e4), right_and_down, 2},
           .unit = "mrad/s",
           .sentence = "of the target; matters where the sensor has a time constant",
           .place = of(&SimulationPlan::motion)},
          {.name = "skip",
           .type = effects(MayBeEmpty::yes),
           .sentence = "effects not to simulate, whatever the planner says",
           .place = of(&SimulationPlan::skip),
           .option = {"--skip"}},
          {.name = "force",
           .type = effects(MayBeEmpty::yes),
           .sentence = "effects to simulate, neutral or not",
           .place = of(&SimulationPlan::force),
           .option = {"--force"},
           .check = check_force},
          {.name = "paired",
           .type = FlagKey{},
           .sentence = "graded answers: the twin is shown the camera's own presentations, too, and their ratio decides",
           .place = of(&SimulationPlan::paired)},
      }};
}

PlanSection schedule_section() {
  const auto of = [](auto member) { return in(&Plan::schedule, member); };
  return {.name = "schedule",
          .sentence = "What is shown next, to camera and twin.",
          .keys = {{.name = "kind",
                    .type = ChoiceKey{names_of(all_schedule_kinds)},
                    .sentence = "every combination, or what the answers so far leave open",
                    .place = of(&SchedulePlan::kind),
                    .form = {"Schedule", "planSchedule"}},
                   {.name = "half_width_percent",
                    .type = NumberKey{NumberRange::above_to(0, 100)},
                    .unit = "%",
                    .sentence = "adaptive: wanted half-width of the 95 % interval of S75",
                    .place = of(&SchedulePlan::half_width_percent),
                    .form = {"Adaptive: half width", "planHalfWidth"}},
                   {.name = "max_presentations",
                    .type = WholeKey{1, 1000000},
                    .sentence = "adaptive: hard cap over all contrasts",
                    .place = of(&SchedulePlan::max_presentations)},
                   {.name = "answers",
                    .type = ChoiceKey{names_of(all_answers_choices)},
                    .sentence = "right or wrong, or how probable the right answer is for what was seen; automatic: the "
                                "latter where the function of the twin is fitted",
                    .place = of(&SchedulePlan::answers)},
                   {.name = "frames_per_presentation",
                    .type = WholesKey{{0, 1000}},
                    .sentence = "successive good frames over which graded answers are averaged, of every contrast or "
                                "one number for each of delta_t_k; 0: chosen, see measurement-method.md",
                    .place = of(&SchedulePlan::frames_per_presentation),
                    .check = check_frames_per_presentation}}};
}

PlanSection fit_section() {
  return {.name = "fit",
          .sentence = "The psychometric function that is fitted to the answers.",
          .keys = {{.name = "form",
                    .type = ChoiceKey{names_of(all_psychometric_forms)},
                    .sentence = "a Weibull function in size or in acuity",
                    .place = in(&Plan::fit, &FitPlan::form)},
                   {.name = "lapse",
                    .type = NumberOrWordKey{NumberRange::between(0, 0.1), "free"},
                    .sentence = "share of wrong answers to triangles that are plainly seen",
                    .place = in(&Plan::fit, &FitPlan::lapse)},
                   {.name = "estimator",
                    .type = ChoiceKey{names_of(all_estimator_choices)},
                    .sentence = "the form above, or the function of the simulated twin, stretched in size; automatic: "
                                "the twin's where there is one",
                    .place = in(&Plan::fit, &FitPlan::estimator),
                    .check = check_estimator}}};
}

PlanSection measurement_section() {
  const auto of = [](auto member) { return in(&Plan::measurement, member); };
  return {.name = "measurement",
          .sentence = "How frames are taken and when they are refused.",
          .keys = {
              {.name = "registration_frames",
               .type = WholeKey{1, 10000},
               .sentence = "averaged to find the plate, once per plate and mounting",
               .place = of(&MeasurementPlan::registration_frames)},
              {.name = "contrast_frames",
               .type = WholeKey{1, 10000},
               .sentence = "averaged for the effective contrast, once per plate, mounting and contrast",
               .place = of(&MeasurementPlan::contrast_frames)},
              {.name = "min_reference_px",
               .type = NumberKey{positive},
               .unit = "px",
               .sentence = "triangles from this size measure the effective contrast",
               .place = of(&MeasurementPlan::min_reference_px)},
              {.name = "frames_after_change",
               .type = WholeKey{0, 10000},
               .sentence = "exposures discarded after the target moved",
               .place = of(&MeasurementPlan::frames_after_change)},
              {.name = "max_rejected_share",
               .type = NumberKey{share},
               .sentence = "of the frames; beyond it, after 100 frames, the run ends",
               .place = of(&MeasurementPlan::max_rejected_share)},
              {.name = "max_saturated_share",
               .type = NumberKey{share},
               .sentence = "of the pixels of a frame that is measured",
               .place = of(&MeasurementPlan::max_saturated_share)},
              {.name = "frame_timeout_ms",
               .type = WholeKey{1, 600000},
               .unit = "ms",
               .sentence = "a camera that is silent for longer is lost",
               .place = of(&MeasurementPlan::frame_timeout_ms)},
              {.name = "max_scale_deviation",
               .type = NumberKey{NumberRange::above_to(0, 0.5)},
               .sentence = "share by which the magnification may differ from that of distance and IFOV",
               .place = of(&MeasurementPlan::max_scale_deviation)},
              {.name = "max_rotation_deg",
               .type = NumberKey{NumberRange::above_to(0, 45)},
               .unit = "deg",
               .sentence = "by which the plate may be turned",
               .place = of(&MeasurementPlan::max_rotation_deg)},
              {.name = "max_residual_px",
               .type = NumberKey{NumberRange::above_to(0, 5)},
               .unit = "px",
               .sentence = "rms by which the triangles may miss their places",
               .place = of(&MeasurementPlan::max_residual_px)},
              {.name = "max_readback_deviation_k",
               .type = NumberKey{NumberRange::positive()},
               .unit = "K",
               .sentence = "by which the contrast that a target reads back may miss its set-point without a note",
               .place = of(&MeasurementPlan::max_readback_deviation_k)},
              {.name = "record_frames",
               .type = FlagKey{},
               .sentence = "keep every frame in the session, for todbench replay",
               .place = of(&MeasurementPlan::record_frames),
               .form = {"Keep frames, for a replay", "planRecord"},
               .option = {"--record-frames", OptionOf::measurements}},
          }};
}

}  // namespace todbench
