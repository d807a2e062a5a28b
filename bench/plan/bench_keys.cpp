// SPDX-License-Identifier: GPL-3.0-or-later
// Plan keys of names, camera, target, motion, instruments and modules.
#include "bench/plan/plan_sections.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "bench/plan/bench_checks.h"
#include "bench/plan/collimator.h"
#include "bench/plan/key_places.h"
#include "bench/plan/plan_options.h"
#include "bench/plan/run_checks.h"

namespace todbench {

namespace {

std::vector<PlanKey> change_keys() {
  const auto key = [](std::string_view name, std::string_view sentence, double TargetPlan::*member) {
    return PlanKey{.name = name,
                   .type = NumberKey{up_to_seconds},
                   .unit = "s",
                   .sentence = sentence,
                   .place = in(&Plan::target, member)};
  };
  return {key("plate_change_s",
              "Duration of a change of the plate. The order of the presentations follows from these four durations",
              &TargetPlan::plate_change_s),
          key("mounting_change_s", "Duration of a change of the mounting", &TargetPlan::mounting_change_s),
          key("contrast_change_s", "Duration of a change of the contrast", &TargetPlan::contrast_change_s),
          key("shift_change_s", "Duration of a sub-pixel shift", &TargetPlan::shift_change_s)};
}

/// Keeps the frames of each contrast that remains; those of a new contrast are left open.
KeyPlace contrasts_place() {
  KeyPlace place = in(&Plan::target, &TargetPlan::delta_t_k);
  place.set = [set = place.set](Plan& plan, std::size_t row, const KeyValue& value) {
    const Plan before = plan;
    set(plan, row, value);
    std::vector<int>& frames = plan.schedule.frames_per_presentation;
    if (frames.size() < 2 || plan.target.delta_t_k == before.target.delta_t_k) return;
    frames.clear();
    for (const double delta_t_k : plan.target.delta_t_k) frames.push_back(frames_at(before, delta_t_k));
  };
  return place;
}

}  // namespace

PlanSection about_section() {
  return {.name = "",
          .sentence = "Name, people and place of the measurement. The report shows them.",
          .keys = {
              {.name = "name",
               .type = TextKey{},
               .sentence = "Name of the measurement. The session folder is named after it",
               .place = in_plan(&Plan::name),
               .form = {"Name", "planName"}},
              {.name = "description",
               .type = TextKey{},
               .sentence = "Description in the report",
               .place = in_plan(&Plan::description),
               .form = {"Description", "planDescription"}},
              {.name = "operator",
               .type = TextKey{},
               .sentence = "Person who runs the measurement",
               .place = in_plan(&Plan::operator_name),
               .form = {"Operator", "planOperator"}},
              {.name = "place",
               .type = TextKey{},
               .sentence = "Place of the measurement",
               .place = in_plan(&Plan::place),
               .form = {"Place", "planPlace"}},
              {.name = "unit",
               .type = TextKey{},
               .sentence = "Unit under test, in free text",
               .place = in_plan(&Plan::unit),
               .form = {"Unit under test", "planUnit"}},
              {.name = "notes",
               .type = TextKey{},
               .sentence = "Notes for the report, in free text",
               .place = in_plan(&Plan::notes),
               .form = {"Notes", "planNotes"}},
              {.name = "seed",
               .type = WholeKey{0, std::numeric_limits<std::int64_t>::max()},
               .sentence = "Seed of all random numbers. The same seed gives the same result",
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
           .sentence = "Camera, as `todbench devices` lists it: SCHEME:NAME",
           .place = of(&CameraPlan::id),
           .form = {"Camera", "planCamera"},
           .check = check_camera_id},
          {.name = "ifov_mrad",
           .type = NumberKey{NumberRange::between(0, 1000)},
           .unit = "mrad",
           .sentence = "IFOV of one pixel. Required, and above 0, if the camera has an id",
           .place = of(&CameraPlan::ifov_mrad),
           .form = {"IFOV of a pixel", "planIfov"},
           .narrowed =
               [](const Plan& plan) {
                 return plan.camera.id.empty() ? std::nullopt : std::optional(NumberRange::between(1e-4, 1000));
               }},
          {.name = "nuc_interval_s",
           .type = NumberKey{up_to_seconds},
           .unit = "s",
           .sentence = "Interval between commanded non-uniformity corrections; 0: none",
           .place = of(&CameraPlan::nuc_interval_s),
           .form = {"NUC interval", "planNuc"}},
          {.name = "reconnect_s",
           .type = NumberKey{up_to_seconds},
           .unit = "s",
           .sentence = "Longest wait for the return of a lost camera; 0: no wait",
           .place = of(&CameraPlan::reconnect_s)},
          {.name = "nuc_wait_s",
           .type = NumberKey{up_to_seconds},
           .unit = "s",
           .sentence = "Time after a correction during which frames are not measured",
           .place = of(&CameraPlan::nuc_wait_s)},
          {.name = "contrast",
           .type = ChoiceKey{names_of(all_contrast_units)},
           .sentence =
               "Unit of the picture: kelvin of the camera's temperature scale, or grey levels. Choose grey levels for "
               "a camera with gain control: the contrast then follows from the large triangles of every frame",
           .place = of(&CameraPlan::contrast),
           .check = check_contrast_unit},
          {.name = "frame_size",
           .type = TextKey{},
           .sentence = "Size of the frames, WIDTHxHEIGHT, for example 640x512. State it if the camera offers several "
                       "sizes, or sends another size than it reports",
           .place = of(&CameraPlan::frame_size),
           .check = check_frame_size},
          {.name = "nuc_command",
           .type = TextKey{},
           .sentence = "Feature of the camera that starts a non-uniformity correction. State it if the program does "
                       "not find it by its name",
           .place = of(&CameraPlan::nuc_command)},
          {.name = "settings",
           .type = FreeTableKey{},
           .sentence =
               "Features of the camera and their values, [camera.settings]. They are set before the run and read back",
           .place = of(&CameraPlan::settings),
           .form = {"Camera settings", "planCameraSettings"}},
      }};
}

PlanSection target_section() {
  const auto of = [](auto member) { return in(&Plan::target, member); };
  PlanSection section{
      .name = "target",
      .sentence = "The target. Every plate is shown in every mounting, at every contrast and in every phase.",
      .keys = {
          {.name = "kind",
           .type = ChoiceKey{names_of(all_target_kinds)},
           .sentence = "How the target is changed: instruments on the network (scpi), a person who is prompted "
                       "(prompt), the scene of a simulated camera (scene) or a monitor (display)",
           .place = of(&TargetPlan::kind),
           .form = {"Target", "planTarget"}},
          {.name = "black_body",
           .type = TextKey{},
           .sentence = "Address of the black body: HOST:PORT, serial:/dev/NAME or vxi11:HOST. Required for kind scpi",
           .place = of(&TargetPlan::black_body),
           .form = {"Black body", "planBlackBody"},
           .check = check_black_body},
          {.name = "stage",
           .type = TextKey{},
           .sentence = "Address of the stage that moves the plate, in the same forms. Required for kind scpi",
           .place = of(&TargetPlan::stage),
           .form = {"Stage", "planStage"},
           .check = check_stage},
          {.name = "black_body_table",
           .type = ResourceKey{ResourceKind::black_body},
           .sentence = "Command table of the black body (reference/instruments.md)",
           .place = of(&TargetPlan::black_body_table),
           .form = {"Command table of the black body", "planBlackBodyTable"}},
          {.name = "stage_table",
           .type = ResourceKey{ResourceKind::stage},
           .sentence = "Command table of the stage (reference/instruments.md)",
           .place = of(&TargetPlan::stage_table),
           .form = {"Command table of the stage", "planStageTable"}},
          {.name = "display",
           .type = TextKey{},
           .sentence = "Kind display: shell command of the program that shows the pictures",
           .place = of(&TargetPlan::display)},
          {.name = "display_width_px",
           .type = WholeKey{64, 16384},
           .sentence = "Kind display: width of the picture in pixels, at most that of the screen",
           .place = of(&TargetPlan::display_width_px)},
          {.name = "display_height_px",
           .type = WholeKey{64, 16384},
           .sentence = "Kind display: height of the picture in pixels, at most that of the screen",
           .place = of(&TargetPlan::display_height_px)},
          {.name = "display_pixel_mm",
           .type = NumberKey{NumberRange::between(0, 100)},
           .unit = "mm",
           .sentence = "Pixel pitch of the screen, centre to centre. Required for kind display",
           .place = of(&TargetPlan::display_pixel_mm),
           .check = check_display_pixel},
          {.name = "display_span_k",
           .type = NumberKey{NumberRange::between(0, 1000)},
           .unit = "K",
           .sentence = "Contrast between black and white of the screen, in kelvin of the camera's scale. Required for "
                       "kind display",
           .place = of(&TargetPlan::display_span_k),
           .check = check_display_span},
          {.name = "display_gamma",
           .type = NumberKey{NumberRange::between(0.2, 5)},
           .sentence = "Exponent of the screen's luminance over its level; 1: luminance in proportion to the level",
           .place = of(&TargetPlan::display_gamma)},
          {.name = "display_luminance",
           .type = NumbersKey{NumberRange::between(0, 1e9), "luminance"},
           .sentence = "Measured luminance at equally spaced levels from black to white, in rising order. It replaces "
                       "display_gamma",
           .place = of(&TargetPlan::display_luminance),
           .check = check_display_luminance},
          {.name = "display_settle_s",
           .type = NumberKey{NumberRange::between(0, 60)},
           .unit = "s",
           .sentence = "Settling time of the panel after a change",
           .place = of(&TargetPlan::display_settle_s)},
          // A wrong default distance would silently scale every result, so a file must state it.
          {.name = "distance_m",
           .type = NumberKey{NumberRange::between(0.01, 1e4)},
           .unit = "m",
           .sentence = "Distance from the entrance pupil to the plate. Required in a file with a [target], except with "
                       "[target.collimator], whose focal length replaces it",
           .place = of(&TargetPlan::distance_m),
           .required = Required::with_section,
           .fallback = {.words = "focal length of the collimator",
                        .value = [](const Plan& plan, const PlanParts&) -> KeyValue {
                          const CollimatorPlan& collimator = plan.target.collimator;
                          // A shorter one is refused by its own key.
                          return collimator.stated()
                                     ? 1e-3 * std::max(least_focal_length_mm, collimator.focal_length_mm)
                                     : plan.target.distance_m;
                        }},
           .replaced = {.by = [](const Plan& plan) { return plan.target.collimator.stated(); },
                        .sentence = "the plan states a distance and a collimator: remove distance_m, because behind a "
                                    "collimator the angle of a triangle is its size over the focal length"},
           .form = {"Distance to plate", "planDistance"},
           .check = check_distance},
          {.name = "plates",
           .type = ResourcesKey{ResourceKind::plate},
           .sentence = "Plates that are shown, by name or file",
           .place = of(&TargetPlan::plates),
           .form = {"Plates", "planPlates"}},
          {.name = "mountings",
           .type = ChoicesKey{names_of(all_mountings), "mounting"},
           .sentence = "Mountings in which each plate is shown",
           .place = of(&TargetPlan::mountings),
           .form = {"Mountings", "planMountings"}},
          {.name = "mountings_per_plate",
           .type = WholesKey{{0, static_cast<std::int64_t>(all_mountings.size())}},
           .sentence = "How many of the mountings, from the first one on, show a plate: one number, or one for each of "
                       "plates; 0: all of them",
           .place = of(&TargetPlan::mountings_per_plate),
           .check = check_mountings_per_plate,
           .written_at_default = false},
          {.name = "delta_t_k",
           .type = NumbersKey{NumberRange::between(-500, 500), "contrast"},
           .unit = "K",
           .sentence = "Set contrasts, triangle minus background, never 0",
           .place = contrasts_place(),
           .form = {"Set contrasts ΔT", "planContrasts"},
           .option = {"--delta-t-k"},
           .check = check_contrasts},
          {.name = "phases",
           .type = WholeKey{1, 10000},
           .sentence = "Sub-pixel shifts per plate, mounting and contrast. More shifts make the interval shorter at "
                       "high contrast",
           .place = of(&TargetPlan::phases),
           .form = {"Phases (sub-pixel shifts)", "planPhases"}},
          {.name = "max_shift_error_px",
           .type = NumberKey{NumberRange::between(0, 5)},
           .unit = "px",
           .sentence = "Largest distance of the plate from the requested place. Beyond it the run ends with exit code "
                       "6; 0: not checked (method/measurement.md)",
           .place = of(&TargetPlan::max_shift_error_px),
           .written_at_default = false},
          {.name = "air_temperature_c",
           .type = NumberKey{NumberRange::between(-40, 60)},
           .unit = "°C",
           .sentence = "Temperature of the air between plate and camera, used with air_humidity_percent",
           .place = of(&TargetPlan::air_temperature_c),
           .form = {"Air temperature", "planAirTemperature"}},
          {.name = "air_humidity_percent",
           .type = NumberKey{NumberRange::between(0, 100)},
           .unit = "%",
           .sentence = "Relative humidity of that air; 0: not stated. If it is stated, the comparison of read-back and "
                       "observed contrast is corrected for the absorption over distance_m (method/uncertainty.md)",
           .place = of(&TargetPlan::air_humidity_percent),
           .form = {"Air humidity", "planAirHumidity"}},
          {.name = "settle_timeout_s",
           .type = NumberKey{NumberRange::between(0.001, 1e7)},
           .unit = "s",
           .sentence = "Longest wait for a stable target. After it the run ends",
           .place = of(&TargetPlan::settle_timeout_s)},
          {.name = "max_contrast_deviation_percent",
           .type = OptionalNumberKey{NumberRange::above_to(0, 100)},
           .unit = "%",
           .sentence = "Largest deviation of the effective contrast from the set contrast for which a verdict is made. "
                       "By default it follows from the uncertainties (method/measurement.md)",
           .place = of(&TargetPlan::max_contrast_deviation_percent)},
          {.name = "contrast_settling_band_percent",
           .type = NumberKey{NumberRange::between(0, 20)},
           .unit = "%",
           .sentence = "A presentation begins when the contrast is within this share of the set contrast and changes "
                       "slowly. Its own frames then give its contrast; 0: the contrast has to settle",
           .place = of(&TargetPlan::contrast_settling_band_percent),
           .check = check_settling_band,
           .written_at_default = false},
          {.name = "max_contrast_lag_s",
           .type = OptionalNumberKey{NumberRange::between(0, 100)},
           .unit = "s",
           .sentence = "Longest time by which the contrast of the small triangles lags that of the large ones while it "
                       "changes. Required for a ramp",
           .place = of(&TargetPlan::max_contrast_lag_s),
           .check = check_contrast_lag},
      }};
  for (PlanKey& key : change_keys()) section.keys.push_back(std::move(key));
  return section;
}

PlanSection motion_section() {
  const auto of = [](auto member) { return in(&Plan::motion, member); };
  return {.name = "motion",
          .sentence = "Passes of a plate that the stage moves along x, for `todbench dynamic PLAN`.",
          .keys = {{.name = "speeds_mrad_s",
                    .type = NumbersKey{NumberRange::between(0, 1e4), "speed"},
                    .unit = "mrad/s",
                    .sentence = "Speeds of the plate. A plate at rest is always added",
                    .place = of(&MotionPlan::speeds_mrad_s),
                    .written_at_default = false},
                   {.name = "passes",
                    .type = WholeKey{2, 10000},
                    .sentence = "Passes per plate, mounting, contrast and speed, to the right and to the left in turn",
                    .place = of(&MotionPlan::passes),
                    .written_at_default = false},
                   {.name = "frames",
                    .type = WholeKey{1, 64},
                    .sentence = "Successive frames of a pass",
                    .place = of(&MotionPlan::frames),
                    .written_at_default = false},
                   {.name = "lead_frames",
                    .type = WholeKey{0, 200},
                    .sentence = "Frames of motion before the first frame that is used. Choose enough for the detector "
                                "to forget the plate at rest",
                    .place = of(&MotionPlan::lead_frames),
                    .written_at_default = false},
                   {.name = "places",
                    .type = ChoiceKey{names_of(all_place_sources)},
                    .sentence = "Place of the plate in a frame: that of its large triangles, or a line at the speed of "
                                "the stage over device time",
                    .place = of(&MotionPlan::places),
                    .written_at_default = false}}};
}

PlanSection instrument_section() {
  const auto rows = [](auto& plan) -> auto& {
    return plan.instruments;
  };
  return {
      .name = "instrument",
      .sentence = "An instrument whose calibration affects the result. The report lists it.",
      .keys =
          {{.name = "name",
            .type = TextKey{},
            .sentence = "Name of the instrument",
            .place = in_row(rows, &InstrumentPlan::name),
            .required = Required::always},
           {.name = "serial",
            .type = TextKey{},
            .sentence = "Serial number",
            .place = in_row(rows, &InstrumentPlan::serial)},
           {.name = "certificate",
            .type = TextKey{},
            .sentence = "Number of the calibration certificate",
            .place = in_row(rows, &InstrumentPlan::certificate)},
           {.name = "calibration_due",
            .type = TextKey{},
            .sentence =
                "Last day on which the calibration is valid, YYYY-MM-DD. If it has passed, the measurement is rejected",
            .place = in_row(rows, &InstrumentPlan::calibration_due),
            .check = check_due_date},
           {.name = "role",
            .type = ChoiceKey{names_of(all_instrument_roles)},
            .sentence = "Part of the instrument on the bench. The serial number is compared with that of the "
                        "instrument that answers. by name: the name contains black body or plate stage",
            .place = in_row(rows, &InstrumentPlan::role),
            .written_at_default = false},
           {.name = "dcc",
            .type = TextKey{},
            .sentence = "Digital calibration certificate of the instrument (XML). The file gives the serial number "
                        "and the number of the certificate, and for a black body the row of the uncertainty budget. "
                        "The session keeps these numbers",
            .place = in_row(rows, &InstrumentPlan::dcc),
            .written_at_default = false},
           {.name = "dcc_quantity",
            .type = TextKey{},
            .sentence = "Name of the quantity of that certificate whose largest uncertainty is the calibration of the "
                        "black body. Empty: the largest of all its temperatures",
            .place = in_row(rows, &InstrumentPlan::dcc_quantity),
            .written_at_default = false}},
      .rows = rows_of(rows),
      .form = {"Instruments", "planInstruments"}};
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
          "A program in the chain (reference/modules.md): behind camera and twin, or in place of the observer's "
          "templates.",
      .keys =
          {{.name = "command",
            .type = TextKey{},
            .sentence = "Shell command that starts the program, in the folder of the caller",
            .place = in_row(rows, &ModulePlan::command),
            .required = Required::always,
            .check = check_module_command},
           {.name = "place",
            .type = ChoiceKey{names_of(all_module_places)},
            .sentence = "Place in the chain: from picture to picture (picture), or from patch to scores (observer)",
            .place = in_row(rows, &ModulePlan::place),
            .check = check_module_place},
           {.name = "version",
            .type = TextKey{},
            .sentence = "Command whose first line of output is recorded in the session",
            .place = in_row(rows, &ModulePlan::version)},
           whole("limit_ms", 1, module_ranges.limit_ms, "ms", "Time limit for an answer", &ModulePlan::limit_ms),
           whole("memory_mib", 0, module_ranges.memory_mib, "MiB", "Limit of the address space; 0: no limit",
                 &ModulePlan::memory_mib),
           {.name = "network",
            .type = FlagKey{},
            .sentence = "Give the program the network of the host",
            .place = in_row(rows, &ModulePlan::network)},
           whole("restart_frames", 0, module_ranges.restart_frames, "",
                 "Number of answers after which a new process is started; 0: never", &ModulePlan::restart_frames),
           whole("settle_frames", 0, module_ranges.settle_frames, "",
                 "Frames discarded after every change of the target, until earlier scenes no longer affect the answer",
                 &ModulePlan::settle_frames),
           {.name = "parameters",
            .type = FreeTableKey{},
            .sentence = "Parameters that are sent to the program in the header, as texts",
            .place = in_row(rows, &ModulePlan::parameters)}},
      .rows = rows_of(rows)};
}

PlanSection report_section() {
  return {.name = "report",
          .sentence = "Appearance of the report.",
          .keys = {{.name = "letterhead",
                    .type = ResourceKey{ResourceKind::letterhead},
                    .sentence = "TOML file with the logo and the texts of the laboratory. The session keeps a copy",
                    .place = in(&Plan::report, &ReportPlan::letterhead),
                    .form = {"Letterhead", "planLetterhead"},
                    .option = {"--letterhead", OptionOf::measurements},
                    .written_at_default = false}}};
}

}  // namespace todbench
