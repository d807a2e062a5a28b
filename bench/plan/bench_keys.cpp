// Keys of what is measured, with what: names, camera, target, motion, instruments, programs in the chain.
#include "bench/plan/plan_sections.h"

#include <limits>
#include <utility>

#include "bench/plan/key_places.h"
#include "bench/plan/plan_checks.h"
#include "bench/plan/plan_options.h"

namespace todbench {

namespace {

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

/// Frames of each contrast go with their contrast; those of a new one are chosen.
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
          {.name = "display_gamma",
           .type = NumberKey{NumberRange::between(0.2, 5)},
           .sentence = "light of the screen is its level to this power; 1: in proportion",
           .place = of(&TargetPlan::display_gamma)},
          {.name = "display_luminance",
           .type = NumbersKey{NumberRange::between(0, 1e9), "luminance"},
           .sentence =
               "in place of display_gamma: luminance as measured, of equally spaced levels from black to white, rising",
           .place = of(&TargetPlan::display_luminance),
           .check = check_display_luminance},
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
           .place = contrasts_place(),
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

PlanSection report_section() {
  return {.name = "report",
          .sentence = "What the report looks like.",
          .keys = {{.name = "letterhead",
                    .type = ResourceKey{ResourceKind::letterhead},
                    .sentence = "logo and texts of the laboratory: a TOML file, which the session keeps",
                    .place = in(&Plan::report, &ReportPlan::letterhead),
                    .form = {"Letterhead", "planLetterhead"},
                    .option = {"--letterhead", OptionOf::measurements},
                    .written_at_default = false}}};
}

}  // namespace todbench
