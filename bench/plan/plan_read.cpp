#include <array>
#include <charconv>
#include <cmath>
#include <set>

#include "bench/plan/descriptions.h"
#include "bench/plan/plan.h"
#include "bench/plan/strict_toml.h"
#include "bench/text/text.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {

namespace {

template <typename Values>
std::vector<std::string> names_of(const Values& values) {
  std::vector<std::string> names;
  for (const auto value : values) names.emplace_back(to_string(value));
  return names;
}

/// The value whose name is `name`; the names have been checked before.
template <typename Values>
auto value_named(const Values& values, std::string_view name) {
  for (const auto value : values) {
    if (to_string(value) == name) return value;
  }
  return values[0];
}

constexpr std::array target_kinds{TargetKind::scpi, TargetKind::prompt, TargetKind::scene};
constexpr std::array forms{PsychometricForm::size, PsychometricForm::acuity};

/// A list of names of an enumeration, each at most once.
template <typename Values>
auto value_list(TomlReader& reader, std::string_view key, const Values& values,
                const std::vector<typename Values::value_type>& fallback) {
  const std::vector<std::string> names = reader.choices(key, names_of(values), names_of(fallback));
  std::vector<typename Values::value_type> list;
  std::set<std::string> seen;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (!seen.insert(names[i]).second) reader.reject(key, i, "'" + names[i] + "' is listed twice");
    list.push_back(value_named(values, names[i]));
  }
  return list;
}

/// A resource that exists and reads without mistakes, as an absolute reference.
template <typename T>
std::string checked_reference(TomlReader& reader, std::string_view key, std::optional<std::size_t> index,
                              const std::string& reference, const std::filesystem::path& folder,
                              Result<T> (*load)(std::string_view)) {
  const std::string absolute = absolute_reference(reference, folder);
  const Result<T> loaded = load(absolute);
  if (!loaded && index) reader.reject(key, *index, loaded.error().message);
  if (!loaded && !index) reader.reject(key, loaded.error().message);
  return absolute;
}

bool is_host_and_port(std::string_view address) {
  const std::size_t colon = address.rfind(':');
  if (colon == std::string_view::npos || colon == 0) return false;
  const std::string_view port = address.substr(colon + 1);
  int number = 0;
  const auto [end, problem] = std::from_chars(port.data(), port.data() + port.size(), number);
  return problem == std::errc() && end == port.data() + port.size() && number >= 1 && number <= 65535 &&
         address.find(' ') == std::string_view::npos;
}

CameraPlan read_camera(TomlReader reader) {
  CameraPlan camera;
  camera.id = reader.text("id", camera.id);
  if (!camera.id.empty() &&
      (camera.id.find(':') == std::string::npos || camera.id.starts_with(':') || camera.id.ends_with(':'))) {
    reader.reject("id", "expected SCHEME:NAME as listed by 'todbench devices', found \"" + one_line(camera.id) + "\"");
  }
  const std::optional<double> ifov_fallback = camera.id.empty() ? std::optional<double>(0) : std::nullopt;
  camera.ifov_mrad = reader.number(
      "ifov_mrad", camera.id.empty() ? NumberRange::not_negative() : NumberRange::positive(), ifov_fallback);
  camera.nuc_interval_s = reader.number("nuc_interval_s", NumberRange::not_negative(), camera.nuc_interval_s);
  camera.reconnect_s = reader.number("reconnect_s", NumberRange::not_negative(), camera.reconnect_s);
  camera.nuc_wait_s = reader.number("nuc_wait_s", NumberRange::not_negative(), camera.nuc_wait_s);
  camera.settings = reader.free_table("settings");
  return camera;
}

std::vector<double> read_contrasts(TomlReader& reader, const std::vector<double>& fallback) {
  const std::vector<double> contrasts = reader.numbers("delta_t_k", NumberRange::between(-500, 500), fallback);
  if (contrasts.empty()) reader.reject("delta_t_k", "expected at least one contrast");
  for (std::size_t i = 0; i < contrasts.size(); ++i) {
    if (contrasts[i] == 0) reader.reject("delta_t_k", i, "a contrast of 0 K shows nothing");
    for (std::size_t j = 0; j < i; ++j) {
      // Curves are paired by contrast within 0.5 %: closer set-points would be one.
      if (!same_contrast(contrasts[i], contrasts[j])) continue;
      reader.reject("delta_t_k", i,
                    number_text(contrasts[i]) + " K is listed twice (contrasts within 0.5 % count as equal)");
    }
  }
  return contrasts;
}

std::vector<std::string> read_plates(TomlReader& reader, const std::vector<std::string>& fallback,
                                     const std::filesystem::path& folder) {
  std::vector<std::string> plates = reader.texts("plates", fallback);
  if (plates.empty()) reader.reject("plates", "expected at least one plate");
  std::set<std::string> seen;
  for (std::size_t i = 0; i < plates.size(); ++i) {
    plates[i] = checked_reference<TargetPlate>(reader, "plates", i, plates[i], folder, load_plate);
    if (!seen.insert(plates[i]).second) reader.reject("plates", i, "'" + plates[i] + "' is listed twice");
  }
  return plates;
}

TargetPlan read_target(TomlReader reader, const std::filesystem::path& folder) {
  TargetPlan target;
  const NumberRange seconds = NumberRange::not_negative();
  target.kind =
      value_named(target_kinds, reader.choice("kind", names_of(target_kinds), std::string(to_string(target.kind))));
  target.black_body = reader.text("black_body", "");
  target.stage = reader.text("stage", "");
  for (const auto& [key, address] : {std::pair("black_body", target.black_body), std::pair("stage", target.stage)}) {
    if (address.empty() && target.kind != TargetKind::scpi) continue;
    if (address.empty()) {
      reader.reject(key, "needed for kind \"scpi\", expected \"HOST:PORT\"");
    } else if (!is_host_and_port(address)) {
      reader.reject(key, "expected \"HOST:PORT\", found \"" + one_line(address) + "\"");
    }
  }
  // A distance that was not stated would silently scale every result: a file has to say it.
  const std::optional<double> distance_fallback =
      reader.present() ? std::nullopt : std::optional<double>(target.distance_m);
  target.distance_m = reader.number("distance_m", NumberRange::positive(), distance_fallback);
  target.plates = read_plates(reader, target.plates, folder);
  target.mountings = value_list(reader, "mountings", all_mountings, target.mountings);
  if (target.mountings.empty()) reader.reject("mountings", "expected at least one mounting");
  target.delta_t_k = read_contrasts(reader, target.delta_t_k);
  target.phases = static_cast<int>(reader.whole("phases", 1, 10000, target.phases));
  target.settle_timeout_s = reader.number("settle_timeout_s", NumberRange::positive(), target.settle_timeout_s);
  target.plate_change_s = reader.number("plate_change_s", seconds, target.plate_change_s);
  target.mounting_change_s = reader.number("mounting_change_s", seconds, target.mounting_change_s);
  target.contrast_change_s = reader.number("contrast_change_s", seconds, target.contrast_change_s);
  target.shift_change_s = reader.number("shift_change_s", seconds, target.shift_change_s);
  return target;
}

SimulationPlan read_simulation(TomlReader reader, int phases, const std::filesystem::path& folder) {
  SimulationPlan simulation;
  const std::vector<std::string> levels{"draft", "normal", "reference", "auto"};
  simulation.sensor = checked_reference<SensorSpec>(reader, "sensor", std::nullopt,
                                                    reader.text("sensor", simulation.sensor), folder, load_sensor);
  const Result<SensorSpec> sensor = load_sensor(simulation.sensor);
  const int own_microscan = sensor ? sensor->microscan : 1;
  simulation.accuracy = reader.choice("accuracy", levels, simulation.accuracy);
  simulation.tolerance_percent =
      reader.number("tolerance_percent", NumberRange::above_to(0, 50), simulation.tolerance_percent);
  simulation.microscan = static_cast<int>(reader.whole("microscan", 1, 4, own_microscan));
  simulation.phases = static_cast<int>(reader.whole("phases", 1, 100000, phases));
  const std::vector<double> motion = reader.numbers("motion_mrad_s", NumberRange::between(-1e4, 1e4),
                                                    {{simulation.motion.x_mrad_s, simulation.motion.y_mrad_s}});
  if (motion.size() == 2) {
    simulation.motion = {.x_mrad_s = motion[0], .y_mrad_s = motion[1]};
  } else {
    reader.reject("motion_mrad_s", "expected two numbers, right and down");
  }
  simulation.skip = value_list(reader, "skip", all_effects, simulation.skip);
  simulation.force = value_list(reader, "force", all_effects, simulation.force);
  for (std::size_t i = 0; i < simulation.force.size(); ++i) {
    for (const Effect skipped : simulation.skip) {
      if (skipped == simulation.force[i])
        reader.reject("force", i, "'" + std::string(to_string(skipped)) + "' is also in skip");
    }
  }
  return simulation;
}

SchedulePlan read_schedule(TomlReader reader) {
  constexpr std::array kinds{ScheduleKind::constant, ScheduleKind::adaptive};
  SchedulePlan schedule;
  schedule.kind = value_named(kinds, reader.choice("kind", names_of(kinds), std::string(to_string(schedule.kind))));
  schedule.half_width_percent =
      reader.number("half_width_percent", NumberRange::above_to(0, 100), schedule.half_width_percent);
  schedule.max_presentations =
      static_cast<int>(reader.whole("max_presentations", 1, 1000000, schedule.max_presentations));
  return schedule;
}

FitPlan read_fit(TomlReader reader) {
  FitPlan fit;
  fit.form = value_named(forms, reader.choice("form", names_of(forms), std::string(to_string(fit.form))));
  fit.lapse = reader.number_or("lapse", NumberRange::between(0, 0.1), "free", fit.lapse);
  return fit;
}

LimitsPlan read_limits(TomlReader reader, const std::vector<double>& contrasts) {
  LimitsPlan limits;
  limits.equivalence_margin_percent =
      reader.optional_number("equivalence_margin_percent", NumberRange::above_to(0, 100));
  for (TomlReader& row : reader.sections("acuity")) {
    AcuityLimit limit;
    limit.delta_t_k = row.number("delta_t_k", NumberRange::any(), std::nullopt);
    limit.least_acuity_per_mrad = row.number("least_acuity_per_mrad", NumberRange::positive(), std::nullopt);
    bool shown = false;
    for (const double contrast : contrasts) shown = shown || same_contrast(contrast, limit.delta_t_k);
    if (!shown) row.reject("delta_t_k", number_text(limit.delta_t_k) + " K is not among the contrasts of [target]");
    for (const AcuityLimit& other : limits.acuity) {
      if (same_contrast(other.delta_t_k, limit.delta_t_k))
        row.reject("delta_t_k", "a second limit at " + number_text(limit.delta_t_k) + " K");
    }
    limits.acuity.push_back(limit);
  }
  return limits;
}

MeasurementPlan read_measurement(TomlReader reader) {
  MeasurementPlan plan;
  const NumberRange share = NumberRange::between(0, 1);
  plan.registration_frames = static_cast<int>(reader.whole("registration_frames", 1, 10000, plan.registration_frames));
  plan.contrast_frames = static_cast<int>(reader.whole("contrast_frames", 1, 10000, plan.contrast_frames));
  plan.min_reference_px = reader.number("min_reference_px", NumberRange::positive(), plan.min_reference_px);
  plan.frames_after_change = static_cast<int>(reader.whole("frames_after_change", 0, 10000, plan.frames_after_change));
  plan.max_rejected_share = reader.number("max_rejected_share", share, plan.max_rejected_share);
  plan.max_saturated_share = reader.number("max_saturated_share", share, plan.max_saturated_share);
  plan.frame_timeout_ms = static_cast<int>(reader.whole("frame_timeout_ms", 1, 600000, plan.frame_timeout_ms));
  plan.max_scale_deviation =
      reader.number("max_scale_deviation", NumberRange::above_to(0, 0.5), plan.max_scale_deviation);
  plan.max_rotation_deg = reader.number("max_rotation_deg", NumberRange::above_to(0, 45), plan.max_rotation_deg);
  plan.record_frames = reader.flag("record_frames", plan.record_frames);
  plan.max_residual_px = reader.number("max_residual_px", NumberRange::above_to(0, 5), plan.max_residual_px);
  plan.max_readback_deviation_k =
      reader.number("max_readback_deviation_k", NumberRange::positive(), plan.max_readback_deviation_k);
  return plan;
}

std::optional<std::chrono::year_month_day> parse_date(std::string_view text) {
  const auto digits = [&](std::size_t first, std::size_t count) {
    int value = -1;
    const auto [end, problem] = std::from_chars(text.data() + first, text.data() + first + count, value);
    return problem == std::errc() && end == text.data() + first + count ? value : -1;
  };
  if (text.size() != 10 || text[4] != '-' || text[7] != '-') return std::nullopt;
  const int year = digits(0, 4), month = digits(5, 2), day = digits(8, 2);
  if (year < 0 || month < 0 || day < 0) return std::nullopt;
  const std::chrono::year_month_day date{std::chrono::year(year), std::chrono::month(static_cast<unsigned>(month)),
                                         std::chrono::day(static_cast<unsigned>(day))};
  return date.ok() ? std::optional(date) : std::nullopt;
}

InstrumentPlan read_instrument(TomlReader& reader) {
  InstrumentPlan instrument;
  instrument.name = reader.text("name", std::nullopt);
  instrument.serial = reader.text("serial", "");
  instrument.certificate = reader.text("certificate", "");
  instrument.calibration_due = reader.text("calibration_due", "");
  if (!instrument.calibration_due.empty() && !parse_date(instrument.calibration_due)) {
    reader.reject("calibration_due",
                  "expected a date \"YYYY-MM-DD\", found \"" + one_line(instrument.calibration_due) + "\"");
  }
  return instrument;
}

}  // namespace

Result<Plan> parse_plan(const Resource& resource, const std::filesystem::path& folder) {
  Result<TomlReader> reader = TomlReader::parse(resource.text, resource.origin);
  if (!reader) return tl::unexpected(reader.error());
  Plan plan;
  plan.name = reader->text("name", plan.name);
  plan.description = reader->text("description", "");
  plan.operator_name = reader->text("operator", "");
  plan.place = reader->text("place", "");
  plan.unit = reader->text("unit", "");
  plan.notes = reader->text("notes", "");
  plan.seed = static_cast<std::uint64_t>(reader->whole("seed", 0, std::numeric_limits<std::int64_t>::max(), 1));
  plan.camera = read_camera(reader->section("camera"));
  plan.target = read_target(reader->section("target"), folder);
  TomlReader observer = reader->section("observer");
  plan.observer = checked_reference<TemplateObserverSpec>(observer, "name", std::nullopt,
                                                          observer.text("name", plan.observer), folder, load_observer);
  plan.simulation = read_simulation(reader->section("simulation"), plan.target.phases, folder);
  plan.schedule = read_schedule(reader->section("schedule"));
  plan.fit = read_fit(reader->section("fit"));
  plan.limits = read_limits(reader->section("limits"), plan.target.delta_t_k);
  plan.measurement = read_measurement(reader->section("measurement"));
  for (TomlReader& instrument : reader->sections("instrument")) plan.instruments.push_back(read_instrument(instrument));
  if (const Result<void> read = reader->finish(); !read) return tl::unexpected(read.error());
  return plan;
}

Result<Plan> load_plan(std::string_view reference) {
  const Result<Resource> resource = find_resource(ResourceKind::plan, reference);
  if (!resource) return tl::unexpected(resource.error());
  return parse_plan(*resource, is_file_reference(reference) ? std::filesystem::path(reference).parent_path() : "");
}

Result<void> check_calibration(const Plan& plan, std::chrono::year_month_day today) {
  std::string overdue;
  for (const InstrumentPlan& instrument : plan.instruments) {
    const std::optional<std::chrono::year_month_day> due = parse_date(instrument.calibration_due);
    if (!due || *due >= today) continue;
    overdue += (overdue.empty() ? "" : ", ") + instrument.name +
               (instrument.serial.empty() ? "" : " " + instrument.serial) + " (due " + instrument.calibration_due + ")";
  }
  if (!overdue.empty()) return fail(ErrorCode::calibration, "calibration overdue: " + overdue);
  return {};
}

}  // namespace todbench
