// The rows. A new key is a member in plan.h and a row here.
#include <limits>

#include "bench/plan/key_places.h"
#include "bench/plan/plan_checks.h"
#include "bench/plan/plan_keys.h"

namespace todbench {

namespace {

const NumberRange positive = NumberRange::positive();
const NumberRange not_negative = NumberRange::not_negative();
const NumberRange share = NumberRange::between(0, 1);
constexpr std::string_view right_and_down = "two numbers, right and down";

PlanSection about_section() {
  return {
      .name = "",
      .sentence = "What the measurement is called and who makes it; for the report.",
      .keys = {
          {.name = "name",
           .type = TextKey{},
           .sentence = "of the measurement; the session folder is called after it",
           .place = in_plan(&Plan::name),
           .form = {"Name", "planName"}},
          {.name = "description", .type = TextKey{}, .sentence = "in the report", .place = in_plan(&Plan::description)},
          {.name = "operator",
           .type = TextKey{},
           .sentence = "who measures",
           .place = in_plan(&Plan::operator_name),
           .form = {"Operator", "planOperator"}},
          {.name = "place",
           .type = TextKey{},
           .sentence = "where it is measured",
           .place = in_plan(&Plan::place),
           .form = {"Place", "planPlace"}},
          {.name = "unit",
           .type = TextKey{},
           .sentence = "unit under test, in the words of who tests it",
           .place = in_plan(&Plan::unit),
           .form = {"Unit under test", "planUnit"}},
          {.name = "notes",
           .type = TextKey{},
           .sentence = "anything else that belongs into the report",
           .place = in_plan(&Plan::notes),
           .form = {"Notes", "planNotes"}},
          {.name = "seed",
           .type = WholeKey{0, std::numeric_limits<std::int64_t>::max()},
           .sentence = "of everything random: the same seed gives the same result",
           .place = in_plan(&Plan::seed)},
      }};
}

PlanSection camera_section() {
  const auto of = [](auto member) { return in(&Plan::camera, member); };
  return {
      .name = "camera",
      .sentence = "The real or emulated camera. Without an id the plan can only be simulated.",
      .keys = {
          {.name = "id",
           .type = TextKey{},
           .sentence = "as `todbench devices` lists it, SCHEME:NAME",
           .place = of(&CameraPlan::id),
           .form = {"Camera", "planCamera"},
           .check = check_camera_id},
          {.name = "ifov_mrad",
           .type = NumberKey{not_negative},
           .unit = "mrad",
           .sentence = "of one pixel; above 0, and required, where the camera has an id",
           .place = of(&CameraPlan::ifov_mrad),
           .form = {"IFOV of a pixel", "planIfov"},
           .narrowed =
               [](const Plan& plan) { return plan.camera.id.empty() ? std::nullopt : std::optional(positive); }},
          {.name = "nuc_interval_s",
           .type = NumberKey{not_negative},
           .unit = "s",
           .sentence = "the camera is told to correct its non-uniformity this often; 0: never",
           .place = of(&CameraPlan::nuc_interval_s),
           .form = {"Correct camera every", "planNuc"}},
          {.name = "reconnect_s",
           .type = NumberKey{not_negative},
           .unit = "s",
           .sentence = "how long a lost camera is waited for; 0: not at all",
           .place = of(&CameraPlan::reconnect_s)},
          {.name = "nuc_wait_s",
           .type = NumberKey{not_negative},
           .unit = "s",
           .sentence = "frames within this time after a correction are not measured",
           .place = of(&CameraPlan::nuc_wait_s)},
          {.name = "contrast",
           .type = ChoiceKey{names_of(all_contrast_units)},
           .sentence =
               "unit of what the camera shows: kelvin of its temperature scale, or grey levels of a camera with "
               "gain control, whose contrast follows from the large triangles of every frame",
           .place = of(&CameraPlan::contrast),
           .check = check_contrast_unit},
          {.name = "settings",
           .type = FreeTableKey{},
           .sentence = "features of the camera and their values, [camera.settings]; set before the run and read back",
           .place = of(&CameraPlan::settings)},
      }};
}

std::vector<PlanKey> change_keys() {
  const auto key = [](std::string_view name, std::string_view sentence, double TargetPlan::*member) {
    return PlanKey{.name = name,
                   .type = NumberKey{not_negative},
                   .unit = "s",
                   .sentence = sentence,
                   .place = in(&Plan::target, member)};
  };
  return {key("plate_change_s", "what another plate takes; the order of presentations follows from these four",
              &TargetPlan::plate_change_s),
          key("mounting_change_s", "what another mounting of a plate takes", &TargetPlan::mounting_change_s),
          key("contrast_change_s", "what another contrast takes", &TargetPlan::contrast_change_s),
          key("shift_change_s", "what a sub-pixel shift takes", &TargetPlan::shift_change_s)};
}

PlanSection target_section() {
  const auto of = [](auto member) { return in(&Plan::target, member); };
  PlanSection section{
      .name = "target",
      .sentence = "What is shown: every plate in every mounting at every contrast in every phase.",
      .keys = {
          {.name = "kind",
           .type = ChoiceKey{names_of(all_target_kinds)},
           .sentence =
               "instruments on the network, an operator who is prompted, the scene of a simulated camera, or a monitor",
           .place = of(&TargetPlan::kind),
           .form = {"Target", "planTarget"}},
          {.name = "black_body",
           .type = TextKey{},
           .sentence = "address of the black body: HOST:PORT, serial:/dev/NAME or vxi11:HOST; needed for kind scpi",
           .place = of(&TargetPlan::black_body),
           .form = {"Black body", "planBlackBody"},
           .check = check_black_body},
          {.name = "stage",
           .type = TextKey{},
           .sentence = "the same of the stage that moves the plate; needed for kind scpi",
           .place = of(&TargetPlan::stage),
           .form = {"Stage", "planStage"},
           .check = check_stage},
          {.name = "black_body_table",
           .type = ResourceKey{ResourceKind::black_body},
           .sentence = "the words of the black body: name or file, see instruments.md",
           .place = of(&TargetPlan::black_body_table),
           .form = {"Words of the black body", "planBlackBodyTable"}},
          {.name = "stage_table",
           .type = ResourceKey{ResourceKind::stage},
           .sentence = "the words of the stage: name or file",
           .place = of(&TargetPlan::stage_table),
           .form = {"Words of the stage", "planStageTable"}},
          {.name = "display",
           .type = TextKey{},
           .sentence = "of kind display: the program that shows pictures, a command for a shell",
           .place = of(&TargetPlan::display)},
          {.name = "display_width_px",
           .type = WholeKey{64, 16384},
           .sentence = "pixels of the picture in a row, at most those of the screen",
           .place = of(&TargetPlan::display_width_px)},
          {.name = "display_height_px",
           .type = WholeKey{64, 16384},
           .sentence = "rows of pixels",
           .place = of(&TargetPlan::display_height_px)},
          {.name = "display_pixel_mm",
           .type = NumberKey{not_negative},
           .unit = "mm",
           .sentence = "of the screen, centre to centre; needed for kind display",
           .place = of(&TargetPlan::display_pixel_mm),
           .check = check_display_pixel},
          {.name = "display_span_k",
           .type = NumberKey{not_negative},
           .unit = "K",
           .sentence =
               "contrast that the camera shows of black beside white, in kelvin of its scale; needed for kind display",
           .place = of(&TargetPlan::display_span_k),
           .check = check_display_span},
          {.name = "display_settle_s",
           .type = NumberKey{NumberRange::between(0, 60)},
           .unit = "s",
           .sentence = "until the panel has changed",
           .place = of(&TargetPlan::display_settle_s)},
          // A distance that was not stated would silently scale every result: a file has to say it.
          {.name = "distance_m",
           .type = NumberKey{positive},
           .unit = "m",
           .sentence = "entrance pupil to plate; required in a file with a [target]",
           .place = of(&TargetPlan::distance_m),
           .required = Required::with_section,
           .form = {"Distance to plate", "planDistance"}},
          {.name = "plates",
           .type = ResourcesKey{ResourceKind::plate},
           .sentence = "names or files",
           .place = of(&TargetPlan::plates),
           .form = {"Plates", "planPlates"}},
          {.name = "mountings",
           .type = ChoicesKey{names_of(all_mountings), "mounting"},
           .sentence = "how each plate is held",
           .place = of(&TargetPlan::mountings),
           .form = {"Mountings", "planMountings"}},
          {.name = "delta_t_k",
           .type = NumbersKey{NumberRange::between(-500, 500), "contrast"},
           .unit = "K",
           .sentence = "contrasts, never 0; the sign is the polarity",
           .place = of(&TargetPlan::delta_t_k),
           .form = {"Contrasts ΔT", "planContrasts"},
           .option = {"--delta-t-k"},
           .check = check_contrasts},
          {.name = "phases",
           .type = WholeKey{1, 10000},
           .sentence = "sub-pixel shifts per plate, mounting and contrast",
           .place = of(&TargetPlan::phases),
           .form = {"Phases (sub-pixel shifts)", "planPhases"}},
          {.name = "air_temperature_c",
           .type = NumberKey{NumberRange::between(-40, 60)},
           .unit = "°C",
           .sentence = "of the air between plate and camera, for air_humidity_percent",
           .place = of(&TargetPlan::air_temperature_c)},
          {.name = "air_humidity_percent",
           .type = NumberKey{NumberRange::between(0, 100)},
           .unit = "%",
           .sentence =
               "relative humidity of that air: what it takes of the contrast over distance_m is corrected in the "
               "comparison of read-back and seen contrast, see uncertainty.md; 0: not stated",
           .place = of(&TargetPlan::air_humidity_percent)},
          {.name = "settle_timeout_s",
           .type = NumberKey{positive},
           .unit = "s",
           .sentence = "a target that is not stable by then ends the run",
           .place = of(&TargetPlan::settle_timeout_s)},
      }};
  for (PlanKey& key : change_keys()) section.keys.push_back(std::move(key));
  return section;
}

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
                    .type = ChoiceKey{names_of(all_answer_kinds)},
                    .sentence = "right or wrong, or how probable the right answer is for what was seen",
                    .place = of(&SchedulePlan::answers)},
                   {.name = "frames_per_presentation",
                    .type = WholeKey{1, 1000},
                    .sentence = "successive good frames over which graded answers are averaged",
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

PlanSection measures_section() {
  const auto of = [](auto member) { return in(&Plan::measures, member); };
  return {.name = "measures",
          .sentence = "Physical measures after the trials, with the same camera and target, and of the twin.",
          .keys = {{.name = "noise",
                    .type = FlagKey{},
                    .sentence = "temporal noise, NETD and 3-D noise of the first plate at a contrast of 0",
                    .place = of(&MeasuresPlan::noise),
                    .form = {"Measure noise and NETD", "planNoise"}},
                   {.name = "noise_frames",
                    .type = WholeKey{5, 10000},
                    .sentence = "of the cube that the noise is measured in",
                    .place = of(&MeasuresPlan::noise_frames)},
                   {.name = "pixels",
                    .type = FlagKey{},
                    .sentence = "bad, blinking and substituted pixels, in the first 256 frames of the noise",
                    .place = of(&MeasuresPlan::pixels),
                    .form = {"Look for bad pixels", "planPixels"},
                    .check = check_pixels},
                   {.name = "pixels_area",
                    .type = ChoiceKey{names_of(all_pixel_areas)},
                    .sentence = "where: what the plate covers, or the frame, where a flat field fills it",
                    .place = of(&MeasuresPlan::pixels_area)},
                   {.name = "pixels_response",
                    .type = NumberKey{NumberRange::above_to(0, 1)},
                    .sentence = "dead: response to temperature off the median's by more than this part of it",
                    .place = of(&MeasuresPlan::pixels_response)},
                   {.name = "pixels_offset",
                    .type = NumberKey{NumberRange::between(1, 1000)},
                    .sentence = "dead or hot: level off by so many times 1.4826 median deviations",
                    .place = of(&MeasuresPlan::pixels_offset)},
                   {.name = "pixels_noisy",
                    .type = NumberKey{NumberRange::between(1.5, 1000)},
                    .sentence = "temporal noise above so many times the median's",
                    .place = of(&MeasuresPlan::pixels_noisy)},
                   {.name = "pixels_blinking",
                    .type = NumberKey{NumberRange::between(2, 1000)},
                    .sentence = "largest change of level, in its standard uncertainty, in the same way",
                    .place = of(&MeasuresPlan::pixels_blinking)},
                   {.name = "transfer",
                    .type = FlagKey{},
                    .sentence = "signal transfer: the contrast seen over the contrast shown",
                    .place = of(&MeasuresPlan::transfer),
                    .form = {"Measure the signal transfer", "planTransfer"}},
                   {.name = "transfer_steps_k",
                    .type = NumbersKey{NumberRange::between(-50, 50), "step"},
                    .unit = "K",
                    .sentence = "contrasts of the signal transfer; the largest also shows where the plate is",
                    .place = of(&MeasuresPlan::transfer_steps_k),
                    .form = {"Steps of the transfer", "planTransferSteps"},
                    .check = check_transfer_steps},
                   {.name = "drift",
                    .type = FlagKey{},
                    .sentence = "growth of the mean and of the spatial noise after a correction of the camera",
                    .place = of(&MeasuresPlan::drift)},
                   {.name = "drift_s",
                    .type = NumberKey{NumberRange::between(2, 3600)},
                    .unit = "s",
                    .sentence = "watched for the drift, or up to the next correction",
                    .place = of(&MeasuresPlan::drift_s)},
                   {.name = "geometry",
                    .type = FlagKey{},
                    .sentence = "IFOV and distortion, from the places of the first plate's triangles",
                    .place = of(&MeasuresPlan::geometry)},
                   {.name = "triangles",
                    .type = FlagKey{},
                    .sentence = "mean pictures of the smallest triangles of the first plate at every contrast",
                    .place = of(&MeasuresPlan::triangles)},
                   {.name = "mtf",
                    .type = FlagKey{},
                    .sentence = "MTF along both axes, from the edges of mtf_plate",
                    .place = of(&MeasuresPlan::mtf),
                    .form = {"Measure the MTF", "planMtf"}},
                   {.name = "mtf_plate",
                    .type = ResourceKey{ResourceKind::plate, PlateUse::mtf},
                    .sentence = "name or file of a plate with slanted rectangles",
                    .place = of(&MeasuresPlan::mtf_plate)},
                   {.name = "mtf_delta_t_k",
                    .type = NumberKey{NumberRange::between(-500, 500)},
                    .unit = "K",
                    .sentence = "contrast at which mtf_plate is shown",
                    .place = of(&MeasuresPlan::mtf_delta_t_k),
                    .check = check_mtf_contrast},
                   {.name = "mtf_frames",
                    .type = WholeKey{1, 10000},
                    .sentence = "averaged for the MTF",
                    .place = of(&MeasuresPlan::mtf_frames)},
                   {.name = "mtf_frequency_per_pitch",
                    .type = NumberKey{NumberRange::above_to(0, 1)},
                    .sentence = "cycles per pixel pitch at which the MTF is stated and limited",
                    .place = of(&MeasuresPlan::mtf_frequency_per_pitch)},
                   {.name = "ctf",
                    .type = FlagKey{},
                    .sentence = "contrast transfer along both axes, from the bars of ctf_plate",
                    .place = of(&MeasuresPlan::ctf),
                    .form = {"Measure the CTF", "planCtf"}},
                   {.name = "ctf_plate",
                    .type = ResourceKey{ResourceKind::plate, PlateUse::ctf},
                    .sentence = "name or file of a plate with bars and squares",
                    .place = of(&MeasuresPlan::ctf_plate)},
                   {.name = "ctf_delta_t_k",
                    .type = NumberKey{NumberRange::between(-500, 500)},
                    .unit = "K",
                    .sentence = "contrast at which ctf_plate is shown",
                    .place = of(&MeasuresPlan::ctf_delta_t_k),
                    .check = check_ctf_contrast},
                   {.name = "ctf_frames",
                    .type = WholeKey{1, 10000},
                    .sentence = "averaged for the CTF",
                    .place = of(&MeasuresPlan::ctf_frames)},
                   {.name = "ctf_frequency_per_pitch",
                    .type = NumberKey{NumberRange::above_to(0, 1)},
                    .sentence = "cycles per pixel pitch; the group of bars nearest to it is stated and limited",
                    .place = of(&MeasuresPlan::ctf_frequency_per_pitch)}}};
}

PlanSection limits_section() {
  return {
      .name = "limits",
      .sentence = "What is demanded of the result.",
      .keys = {
          {.name = "equivalence_margin_percent",
           .type = OptionalNumberKey{NumberRange::above_to(0, 100)},
           .unit = "%",
           .sentence = "demanded agreement with the twin; without it none is demanded",
           .place = in(&Plan::limits, &LimitsPlan::equivalence_margin_percent),
           .form = {"Equivalence margin", "planMargin"},
           .check = check_margin},
          {.name = "rule",
           .type = ChoiceKey{names_of(conformity_rules)},
           .sentence = "how an interval and a limit make a decision, agreed before the measurement",
           .place = in(&Plan::limits, &LimitsPlan::rule),
           .written_at_default = false},
          {.name = "guard_band_risk",
           .type = OptionalNumberKey{NumberRange::between(1e-9, 0.5)},
           .sentence = "of a wrong acceptance at the acceptance limit; without it the guard band is the 95 % interval",
           .place = in(&Plan::limits, &LimitsPlan::guard_band_risk)},
          {.name = "fleet_sd_percent",
           .type = OptionalNumberKey{NumberRange::above_to(0, 100)},
           .unit = "%",
           .sentence = "spread of true acuities over the fleet; todbench plan then states the risks of both sides",
           .place = in(&Plan::limits, &LimitsPlan::fleet_sd_percent)}}};
}

PlanSection measure_limits_section() {
  const auto rows = [](auto& plan) -> auto& {
    return plan.limits.measures;
  };
  return {.name = "limits.measure",
          .sentence =
              "Limits on a physical measure of [measures], in its unit (K; K/K for transfer_slope, 1 for MTF and CTF).",
          .keys = {{.name = "measure",
                    .type = ChoiceKey{names_of(limited_measures)},
                    .sentence = "by its name in measures.json",
                    .place = in_row(rows, &MeasureLimit::measure),
                    .required = Required::always,
                    .check = check_limited_measure},
                   {.name = "at_least",
                    .type = OptionalNumberKey{positive},
                    .sentence = "lower limit of transfer_slope, an MTF, a CTF or an IFOV",
                    .place = in_row(rows, &MeasureLimit::at_least)},
                   {.name = "at_most",
                    .type = OptionalNumberKey{positive},
                    .sentence = "upper limit; MTF and CTF have none",
                    .place = in_row(rows, &MeasureLimit::at_most),
                    .check = check_measure_limits}},
          .rows = rows_of(rows)};
}

PlanSection fleet_section() {
  const auto rows = [](auto& plan) -> auto& {
    return plan.limits.fleets;
  };
  return {.name = "limits.fleet",
          .sentence =
              "What earlier units of this kind say of the next one, as `todbench history prior` writes it; the "
              "verdict then states global risks.",
          .keys = {{.name = "measure",
                    .type = TextKey{},
                    .sentence = "acuity, or a physical measure that can be limited",
                    .place = in_row(rows, &FleetRow::measure),
                    .required = Required::always,
                    .check = check_fleet_measure},
                   {.name = "delta_t_k",
                    .type = OptionalNumberKey{NumberRange::any()},
                    .unit = "K",
                    .sentence = "set contrast of an acuity",
                    .place = in_row(rows, &FleetRow::delta_t_k)},
                   {.name = "mean",
                    .type = NumberKey{positive},
                    .sentence = "of true values, in the unit of the measure; of an acuity the geometric one",
                    .place = in_row(rows, &FleetRow::mean),
                    .required = Required::always},
                   {.name = "sd",
                    .type = NumberKey{positive},
                    .sentence = "standard deviation of true values, in that unit; of an acuity in ln acuity",
                    .place = in_row(rows, &FleetRow::sd),
                    .required = Required::always},
                   {.name = "u",
                    .type = NumberKey{not_negative},
                    .sentence = "standard uncertainty of a value that went into it, on the scale of sd",
                    .place = in_row(rows, &FleetRow::u)},
                   {.name = "units",
                    .type = WholeKey{least_fleet_units, 1000000},
                    .sentence = "that it rests on",
                    .place = in_row(rows, &FleetRow::units),
                    .required = Required::always},
                   {.name = "source",
                    .type = TextKey{},
                    .sentence = "where they are, in words",
                    .place = in_row(rows, &FleetRow::source)}},
          .rows = rows_of(rows)};
}

PlanSection zone_limits_section() {
  const auto rows = [](auto& plan) -> auto& {
    return plan.limits.zones;
  };
  const auto most = [rows](std::string_view name, std::string_view sentence, std::optional<double> ZoneLimit::*member) {
    return PlanKey{
        .name = name, .type = OptionalNumberKey{not_negative}, .sentence = sentence, .place = in_row(rows, member)};
  };
  PlanSection section{
      .name = "limits.zone",
      .sentence = "Most bad and substituted pixels in a part of the frame. Zones do not overlap, but for 'whole'.",
      .keys = {{.name = "name",
                .type = TextKey{},
                .sentence = "of the zone; 'whole' is the frame, whatever its area",
                .place = in_row(rows, &ZoneLimit::name),
                .required = Required::always,
                .check = check_zone_name},
               {.name = "area",
                .type = NumbersKey{share, "four numbers: left, top, right, bottom", 4},
                .sentence = "in fractions of the frame",
                .place = in_row(rows, &ZoneLimit::area),
                .check = check_zone_area},
               most("bad_pixels", "stuck, dead, hot, noisy and blinking ones", &ZoneLimit::bad_pixels),
               most("substituted_pixels", "that the camera has replaced by their neighbours",
                    &ZoneLimit::substituted_pixels),
               most("clusters", "of two bad or substituted pixels that touch, or more", &ZoneLimit::clusters),
               most("largest_cluster", "pixels", &ZoneLimit::largest_cluster)},
      .rows = rows_of(rows)};
  section.keys.back().check = check_zone_limits;
  return section;
}

PlanSection acuity_limits_section() {
  const auto rows = [](auto& plan) -> auto& {
    return plan.limits.acuity;
  };
  return {.name = "limits.acuity",
          .sentence = "The 75 % acuity demanded at a contrast.",
          .keys = {{.name = "delta_t_k",
                    .type = NumberKey{NumberRange::any()},
                    .unit = "K",
                    .sentence = "one of the contrasts of [target]",
                    .place = in_row(rows, &AcuityLimit::delta_t_k),
                    .required = Required::always,
                    .check = check_limit_contrast},
                   {.name = "least_acuity_per_mrad",
                    .type = NumberKey{positive},
                    .unit = "1/mrad",
                    .sentence = "what the unit has to reach there",
                    .place = in_row(rows, &AcuityLimit::least_acuity_per_mrad),
                    .required = Required::always}},
          .rows = rows_of(rows),
          .form = {"Least acuity", "planLimits", "target.delta_t_k"}};
}

PlanSection motion_section() {
  const auto of = [](auto member) { return in(&Plan::motion, member); };
  return {.name = "motion",
          .sentence = "Passes of a plate that the stage moves along x, for `todbench dynamic PLAN`.",
          .keys = {{.name = "speeds_mrad_s",
                    .type = NumbersKey{NumberRange::between(0, 1e4), "speed"},
                    .unit = "mrad/s",
                    .sentence = "speeds; a plate at rest is added",
                    .place = of(&MotionPlan::speeds_mrad_s),
                    .written_at_default = false},
                   {.name = "passes",
                    .type = WholeKey{2, 10000},
                    .sentence = "of every plate, mounting, contrast and speed, to the right and to the left in turn",
                    .place = of(&MotionPlan::passes),
                    .written_at_default = false},
                   {.name = "frames",
                    .type = WholeKey{1, 64},
                    .sentence = "successive frames of a pass",
                    .place = of(&MotionPlan::frames),
                    .written_at_default = false},
                   {.name = "lead_frames",
                    .type = WholeKey{0, 200},
                    .sentence = "frames of motion before the first, until the detector has forgotten the plate at rest",
                    .place = of(&MotionPlan::lead_frames),
                    .written_at_default = false},
                   {.name = "places",
                    .type = ChoiceKey{names_of(all_place_sources)},
                    .sentence = "the plate is where the large triangles of each frame are, or on a line at the stage's "
                                "speed over device time",
                    .place = of(&MotionPlan::places),
                    .written_at_default = false}}};
}

PlanSection uncertainty_section() {
  return {.name = "uncertainty",
          .sentence =
              "What the interval of the finite number of trials does not hold. A plan with rows is judged by the "
              "interval expanded by them.",
          .keys = {{.name = "require",
                    .type = FlagKey{},
                    .sentence = "refuse a plan whose budget leaves out an expected row",
                    .place = in(&Plan::uncertainty, &UncertaintyPlan::require),
                    .check = check_require,
                    .written_at_default = false}}};
}

/// Words of distributions: their names, and what a budget may say in place of them.
const std::vector<std::string>& distribution_words() {
  static const std::vector<std::string> words = [] {
    std::vector<std::string> all = names_of(budget_distributions);
    for (const BudgetDistribution distribution : budget_distributions) {
      if (distribution != BudgetDistribution::normal)
        all.push_back(std::string(to_string(distribution)) + " half-width");
    }
    return all;
  }();
  return words;
}

/// "rectangular half-width" is "rectangular".
KeyPlace distribution_place() {
  return {
      .get = [](const Plan& plan, std::size_t row) { return to_key_value(plan.uncertainty.rows[row].distribution); },
      .set =
          [](Plan& plan, std::size_t row, const KeyValue& value) {
            const auto& word = std::get<std::string>(value);
            plan.uncertainty.rows[row].distribution = value_named<BudgetDistribution>(word.substr(0, word.find(' ')));
          }};
}

PlanSection budget_row_section() {
  const auto rows = [](auto& plan) -> auto& {
    return plan.uncertainty.rows;
  };
  const auto of = [rows](auto member) { return in_row(rows, member); };
  return {
      .name = "uncertainty.component",
      .sentence = "A row of the budget, as in the file of todbench budget.",
      .keys = {{.name = "name",
                .type = TextKey{},
                .sentence = "what is uncertain",
                .place = of(&BudgetRow::name),
                .required = Required::always,
                .check = check_budget_name},
               {.name = "value",
                .type = NumberKey{not_negative},
                .sentence = "standard uncertainty, half-width or amplitude, as the distribution says; 0: known exactly",
                .place = of(&BudgetRow::value),
                .required = Required::always},
               {.name = "unit",
                .type = TextKey{},
                .sentence = "of the value: m, cm, mm, um of lengths, K, mK of contrasts, %, 1",
                .place = of(&BudgetRow::unit),
                .check = check_budget_unit},
               {.name = "distribution",
                .type = ChoiceKey{distribution_words()},
                .sentence = "of the value",
                .place = distribution_place(),
                .other_names = {"kind"}},
               {.name = "coverage_factor",
                .type = NumberKey{positive},
                .sentence = "of a normal value: value / coverage_factor is standard",
                .place = of(&BudgetRow::coverage_factor),
                .check = check_coverage_factor},
               {.name = "degrees_of_freedom",
                .type = NumberOrWordKey{NumberRange::between(1, 1e300), "infinite"},
                .sentence = "of the value",
                .place = of(&BudgetRow::degrees_of_freedom),
                .other_names = {"nu"}},
               {.name = "enters",
                .type = ChoiceKey{names_of(budget_inputs)},
                .sentence = "through what the row reaches the acuity",
                .place = of(&BudgetRow::enters),
                .written_at_default = false},
               {.name = "sensitivity",
                .type = OptionalNumberKey{NumberRange::any()},
                .sentence = "of ln acuity to the value; without it that of what the row enters",
                .place = of(&BudgetRow::sensitivity)},
               {.name = "source",
                .type = TextKey{},
                .sentence = "what the value rests on",
                .place = of(&BudgetRow::source)},
               {.name = "certificate",
                .type = TextKey{},
                .sentence = "number of its certificate",
                .place = of(&BudgetRow::certificate)},
               {.name = "common",
                .type = ChoicesKey{names_of(budget_commons), "word", MayBeEmpty::yes},
                .sentence = "with what the row is shared: it cancels in a ratio to it",
                .place = of(&BudgetRow::common)}},
      .rows = rows_of(rows),
      .other_names = {"components", "row", "rows"}};
}

PlanSection instrument_section() {
  const auto rows = [](auto& plan) -> auto& {
    return plan.instruments;
  };
  return {.name = "instrument",
          .sentence = "An instrument that the calibration of the result hangs on; for the report.",
          .keys = {{.name = "name",
                    .type = TextKey{},
                    .sentence = "what it is",
                    .place = in_row(rows, &InstrumentPlan::name),
                    .required = Required::always},
                   {.name = "serial",
                    .type = TextKey{},
                    .sentence = "its serial number",
                    .place = in_row(rows, &InstrumentPlan::serial)},
                   {.name = "certificate",
                    .type = TextKey{},
                    .sentence = "number of its calibration certificate",
                    .place = in_row(rows, &InstrumentPlan::certificate)},
                   {.name = "calibration_due",
                    .type = TextKey{},
                    .sentence = "\"YYYY-MM-DD\", the last valid day; a date that has passed refuses the measurement",
                    .place = in_row(rows, &InstrumentPlan::calibration_due),
                    .check = check_due_date}},
          .rows = rows_of(rows)};
}

PlanSection module_section() {
  const auto rows = [](auto& plan) -> auto& {
    return plan.modules;
  };
  const auto whole = [rows](std::string_view name, int low, int high, std::string_view unit, std::string_view sentence,
                            int ModulePlan::*member) {
    return PlanKey{
        .name = name, .type = WholeKey{low, high}, .unit = unit, .sentence = sentence, .place = in_row(rows, member)};
  };
  return {
      .name = "module",
      .sentence =
          "A program in the chain (docs/modules.md): behind camera and twin, or in place of the observer's templates.",
      .keys = {{.name = "command",
                .type = TextKey{},
                .sentence = "for a shell, in the folder of the caller",
                .place = in_row(rows, &ModulePlan::command),
                .required = Required::always,
                .check = check_module_command},
               {.name = "place",
                .type = ChoiceKey{names_of(all_module_places)},
                .sentence = "picture to picture, or patch to scores",
                .place = in_row(rows, &ModulePlan::place),
                .check = check_module_place},
               {.name = "version",
                .type = TextKey{},
                .sentence = "a command whose first line of output is kept in the session",
                .place = in_row(rows, &ModulePlan::version)},
               whole("limit_ms", 1, module_ranges.limit_ms, "ms", "for an answer", &ModulePlan::limit_ms),
               whole("memory_mib", 0, module_ranges.memory_mib, "MiB", "of address space; 0: no limit",
                     &ModulePlan::memory_mib),
               {.name = "network",
                .type = FlagKey{},
                .sentence = "keeps the network of the host",
                .place = in_row(rows, &ModulePlan::network)},
               whole("restart_frames", 0, module_ranges.restart_frames, "",
                     "a new process after so many answers; 0: never", &ModulePlan::restart_frames),
               whole("settle_frames", 0, module_ranges.settle_frames, "",
                     "frames left out after every change of the target, until it has forgotten what it saw before",
                     &ModulePlan::settle_frames),
               {.name = "parameters",
                .type = FreeTableKey{},
                .sentence = "handed over in the header, as texts",
                .place = in_row(rows, &ModulePlan::parameters)}},
      .rows = rows_of(rows)};
}

}  // namespace

const std::vector<PlanSection>& plan_sections() {
  static const std::vector<PlanSection> sections{
      about_section(),       camera_section(),   target_section(),        observer_section(),
      simulation_section(),  schedule_section(), fit_section(),           measurement_section(),
      measures_section(),    limits_section(),   acuity_limits_section(), measure_limits_section(),
      zone_limits_section(), fleet_section(),    uncertainty_section(),   budget_row_section(),
      instrument_section(),  module_section(),   motion_section()};
  return sections;
}

}  // namespace todbench
