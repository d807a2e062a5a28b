// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/plan/descriptions.h"

#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "acquisition/base/try.h"
#include "bench/plan/strict_toml.h"
#include "sim_devices/sensor/sensor_key.h"

namespace todbench {

namespace {

constexpr const char* needs_display_here =
    "the observer has an eye and needs a display, which this command does not have; use simulate, measure or plan with "
    "a plan that has a section [display], or an observer without an eye (hvs-1)";

/// Ranges of plate dimensions, in mm.
const NumberRange length_range = NumberRange::between(0.02, 1e4);
const NumberRange place_range = NumberRange::between(-1e4, 1e4);

/// Returns the description if its file had no mistakes and the component that uses it accepts the whole.
template <typename T>
Result<T> checked(const TomlReader& reader, const Resource& resource, T value) {
  TODBENCH_TRY_VOID(reader.finish());
  if (const Result<void> possible = validate(value); !possible) return fail(resource.origin, possible.error());
  return value;
}

void read_row(TomlReader& row, std::size_t number, TargetPlate& plate) {
  static const std::vector<std::string> apex_names = [] {
    std::vector<std::string> names;
    for (const Apex apex : all_apexes) names.emplace_back(to_string(apex));
    return names;
  }();
  const double size_mm = row.number("size_mm", length_range, std::nullopt);
  const double y_mm = row.number("y_mm", place_range, std::nullopt);
  const std::vector<double> x_mm = row.numbers("x_mm", place_range, std::nullopt);
  const std::vector<std::string> apexes = row.choices("apex", apex_names, std::nullopt);
  const std::vector<std::string> names = row.texts("names", std::vector<std::string>());
  const auto one_each = [&](const char* key, std::size_t count) {
    if (count == x_mm.size()) return true;
    row.reject(key, "expected " + std::to_string(x_mm.size()) + " values as in x_mm, found " + std::to_string(count));
    return false;
  };
  if (!one_each("apex", apexes.size()) || (row.has("names") && !one_each("names", names.size()))) return;
  for (std::size_t i = 0; i < x_mm.size(); ++i) {
    PlateTriangle triangle;
    triangle.name =
        i < names.size() ? names[i] : "row " + std::to_string(number) + ", triangle " + std::to_string(i + 1);
    triangle.position_mm = {x_mm[i], y_mm};
    triangle.size_mm = size_mm;
    triangle.apex = apex_from(apexes[i]).value_or(Apex::up);
    plate.triangles.push_back(std::move(triangle));
  }
}

PlateRectangle read_rectangle(TomlReader& table, std::size_t number) {
  PlateRectangle rectangle;
  rectangle.name = table.text("name", "rectangle " + std::to_string(number));
  rectangle.position_mm.x = table.number("x_mm", place_range, std::nullopt);
  rectangle.position_mm.y = table.number("y_mm", place_range, std::nullopt);
  rectangle.size_mm.width = table.number("width_mm", length_range, std::nullopt);
  rectangle.size_mm.height = table.number("height_mm", length_range, std::nullopt);
  rectangle.angle_deg = table.number("angle_deg", NumberRange::between(-90, 90), 0.0);
  return rectangle;
}

PlateBars read_bars(TomlReader& table, std::size_t number) {
  PlateBars bars;
  bars.name = table.text("name", "bars " + std::to_string(number));
  bars.position_mm.x = table.number("x_mm", place_range, std::nullopt);
  bars.position_mm.y = table.number("y_mm", place_range, std::nullopt);
  bars.bar_mm = table.number("bar_mm", length_range, std::nullopt);
  bars.length_mm = table.number("length_mm", length_range, std::nullopt);
  const std::string axis = table.choice("axis", std::vector<std::string>{"x", "y"}, std::nullopt);
  bars.angle_deg = table.number("angle_deg", NumberRange::between(-45, 45), 0.0) + (axis == "y" ? 90 : 0);
  return bars;
}

/// Adds a group of four bars; the bars of a group of five become rectangles "NAME, bar 1" to "NAME, bar 5".
void add_bars(TomlReader& table, std::size_t number, TargetPlate& plate) {
  const std::int64_t count = table.whole("bars", 4, 5, 4);
  const PlateBars group = read_bars(table, number);
  if (count == 4) {
    plate.bars.push_back(group);
    return;
  }
  const double angle = group.angle_deg * std::numbers::pi / 180;
  for (std::int64_t i = 0; i < count; ++i) {
    plate.rectangles.push_back({group.name + ", bar " + std::to_string(i + 1),
                                group.position_mm + cv::Point2d(std::cos(angle), std::sin(angle)) *
                                                        (2 * (static_cast<double>(i) - 2) * group.bar_mm),
                                {group.bar_mm, group.length_mm},
                                group.angle_deg});
  }
}

/// Optional keys fall back to the default of the struct.
void read_key(TomlReader& reader, const SensorKey& key, SensorSpec& spec) {
  const bool required = key.presence == KeyPresence::required;
  if (const auto* number = std::get_if<double SensorSpec::*>(&key.member)) {
    double& value = spec.*(*number);
    value = reader.number(key.name, key.range, required ? std::nullopt : std::optional(value));
  } else if (const auto* whole = std::get_if<int SensorSpec::*>(&key.member)) {
    int& value = spec.*(*whole);
    const auto fallback = required ? std::nullopt : std::optional<std::int64_t>(value);
    const auto low = static_cast<std::int64_t>(key.range.low), high = static_cast<std::int64_t>(key.range.high);
    value = static_cast<int>(reader.whole(key.name, low, high, fallback));
  } else {
    static const std::vector<std::string> words = {std::string(to_string(DisplayReconstruction::sample_and_hold)),
                                                   std::string(to_string(DisplayReconstruction::bilinear))};
    const auto member = std::get<DisplayReconstruction SensorSpec::*>(key.member);
    spec.*member = reader.choice(key.name, words, std::string(to_string(spec.*member))) == words[1]
                       ? DisplayReconstruction::bilinear
                       : DisplayReconstruction::sample_and_hold;
  }
}

/// Checks the record of `todbench observer fit`. Nothing in it affects the observer, but a record that the program did
/// not write is rejected.
void read_fit(TomlReader fit) {
  if (!fit.present()) return;
  const NumberRange any = NumberRange::between(-1e9, 1e9), share = NumberRange::between(0, 1);
  (void)fit.choice("schema", std::vector<std::string>{"todbench-observer-fit-1"}, std::nullopt);
  for (const char* key : {"program", "from", "from_sha256"}) (void)fit.text(key, std::nullopt);
  (void)fit.texts("free", std::nullopt);
  for (const char* key : {"persons", "answers", "seed", "draws"})
    (void)fit.whole(key, 0, std::numeric_limits<std::int64_t>::max(), std::nullopt);
  (void)fit.number("lapse", share, std::nullopt);
  (void)fit.number("least_model_p", share, std::nullopt);
  for (TomlReader& parameter : fit.sections("parameter")) {
    (void)parameter.text("name", std::nullopt);
    (void)parameter.number("value", any, std::nullopt);
    for (const char* key : {"ci95_low", "ci95_high", "between_sd"}) (void)parameter.optional_number(key, any);
  }
  for (TomlReader& pair : fit.sections("correlation")) {
    (void)pair.texts("of", std::nullopt);
    (void)pair.number("value", NumberRange::between(-1, 1), std::nullopt);
  }
  for (TomlReader& session : fit.sections("session")) {
    for (const char* key : {"folder", "manifest_sha256", "shown_sha256"}) (void)session.text(key, std::nullopt);
    (void)session.text("person_code", "");
    for (const char* key : {"person", "answers"})
      (void)session.whole(key, 0, std::numeric_limits<std::int64_t>::max(), std::nullopt);
  }
}

template <typename T>
Result<T> load(ResourceKind kind, std::string_view reference, Result<T> (*parse)(const Resource&)) {
  TODBENCH_TRY(const Resource resource, find_resource(kind, reference));
  return parse(resource);
}

}  // namespace

ModulePlan read_module(TomlReader& table) {
  const auto whole = [&](const char* key, int low, int high, int fallback) {
    return static_cast<int>(table.whole(key, low, high, fallback));
  };
  ModulePlan module;
  module.command = table.text("command", std::nullopt);
  if (table.has("command") && module.command.empty())
    table.reject("command", "expected a command, found an empty text");
  module.version = table.text("version", "");
  module.parameters = table.free_table("parameters");
  module.limit_ms = whole("limit_ms", 1, module_ranges.limit_ms, module.limit_ms);
  module.memory_mib = whole("memory_mib", 0, module_ranges.memory_mib, module.memory_mib);
  module.network = table.flag("network", module.network);
  module.restart_frames = whole("restart_frames", 0, module_ranges.restart_frames, module.restart_frames);
  module.settle_frames = whole("settle_frames", 0, module_ranges.settle_frames, module.settle_frames);
  return module;
}

Result<SensorSpec> parse_sensor(const Resource& resource) {
  TODBENCH_TRY(TomlReader reader, TomlReader::parse(resource.text, resource.origin));
  SensorSpec spec;
  spec.name = reader.text("name", std::nullopt);
  spec.description = reader.text("description", spec.description);
  for (const SensorKey& key : sensor_keys()) read_key(reader, key, spec);
  auto modules = reader.sections("module");
  for (TomlReader& table : modules) {
    // A sensor has no observer.
    const std::vector<std::string> places{std::string(to_string(ModulePlace::picture)),
                                          std::string(to_string(ModulePlace::sensor))};
    const bool sensor = table.choice("place", places, places.front()) == places.back();
    if (sensor && !spec.modules.empty())
      table.reject("place", "a module with place = \"sensor\" must be the first one of its file");
    spec.modules.push_back(read_module(table));
    if (sensor) spec.modules.back().place = ModulePlace::sensor;
  }
  return checked(reader, resource, std::move(spec));
}

/// Reads the [eye] of an observer; empty without one.
std::optional<EyeParameters> read_eye(TomlReader table) {
  if (!table.present()) return std::nullopt;
  EyeParameters eye;
  const std::pair<std::string_view, double EyeParameters::*> keys[] = {
      {"sensitivity", &EyeParameters::sensitivity},
      {"photon_noise_td", &EyeParameters::photon_noise_td},
      {"inhibition_per_degree", &EyeParameters::inhibition_per_degree},
      {"critical_cycles", &EyeParameters::critical_cycles},
      {"area_exponent", &EyeParameters::area_exponent},
      {"uncertainty_channels", &EyeParameters::uncertainty_channels},
      {"contrast_noise", &EyeParameters::contrast_noise},
      {"age_years", &EyeParameters::age_years},
      {"field_deg2", &EyeParameters::field_deg2}};
  for (const auto& [name, member] : keys) eye.*member = table.number(name, NumberRange::between(0, 1e9), eye.*member);
  return eye;
}

Result<DescribedObserver> parse_observer_with_module(const Resource& resource) {
  TODBENCH_TRY(TomlReader reader, TomlReader::parse(resource.text, resource.origin));
  TemplateObserverSpec spec;
  spec.name = reader.text("name", std::nullopt);
  spec.eye = read_eye(reader.section("eye"));
  if (spec.eye) {
    spec.internal_noise = 0;
    spec.window_margin_arcmin = reader.number("window_margin_arcmin", NumberRange::between(0, 120), 6.0);
  } else {
    spec.blur_sigma_samples = reader.number("blur_sigma_samples", NumberRange::between(0.1, 10), std::nullopt);
    spec.internal_noise = reader.number("internal_noise", NumberRange::between(0, 10), std::nullopt);
  }
  spec.sensor_noise_factor =
      reader.number("sensor_noise_factor", NumberRange::between(1, 100), spec.sensor_noise_factor);
  spec.search_range_samples =
      reader.number("search_range_samples", NumberRange::between(0, 100), spec.search_range_samples);
  spec.search_step_samples =
      reader.number("search_step_samples", NumberRange::between(0.01, 100), spec.search_step_samples);
  spec.window_size_factor = reader.number("window_size_factor", NumberRange::between(0.9, 10), spec.window_size_factor);
  spec.window_margin_pitch =
      reader.number("window_margin_pitch", NumberRange::between(0, 100), spec.window_margin_pitch);
  read_fit(reader.section("fit"));
  DescribedObserver described;
  auto modules = reader.sections("module");
  for (TomlReader& table : modules) {
    const std::vector<std::string> places{std::string(to_string(ModulePlace::observer))};
    (void)table.choice("place", places, places.front());
    if (described.module) table.reject("command", "an observer can have only one module");
    described.module = read_module(table);
    described.module->place = ModulePlace::observer;
  }
  TODBENCH_TRY(described.spec, checked(reader, resource, std::move(spec)));
  return described;
}

Result<TemplateObserverSpec> parse_observer(const Resource& resource) {
  TODBENCH_TRY(auto described, parse_observer_with_module(resource));
  if (described.module) {
    return fail_at(ErrorCode::invalid_input, resource.origin,
                   "the observer has a [[module]], which only compare-models runs; for a plan, state a [[module]] with "
                   "place = \"observer\" in the plan");
  }
  return std::move(described.spec);
}

Result<TargetPlate> parse_plate(const Resource& resource) {
  TODBENCH_TRY(TomlReader reader, TomlReader::parse(resource.text, resource.origin));
  TargetPlate plate;
  plate.name = reader.text("name", std::nullopt);
  plate.description = reader.text("description", "");
  plate.width_mm = reader.number("width_mm", length_range, std::nullopt);
  plate.height_mm = reader.number("height_mm", length_range, std::nullopt);
  std::size_t number = 0;
  for (TomlReader& row : reader.sections("row")) read_row(row, ++number, plate);
  number = 0;
  for (TomlReader& table : reader.sections("rectangle")) plate.rectangles.push_back(read_rectangle(table, ++number));
  number = 0;
  for (TomlReader& table : reader.sections("bars")) add_bars(table, ++number, plate);
  return checked(reader, resource, std::move(plate));
}

Result<SensorSpec> load_sensor(std::string_view reference) {
  auto spec = load(ResourceKind::sensor, reference, parse_sensor);
  if (spec && !spec->modules.empty()) {
    return fail_at(ErrorCode::invalid_input, std::string(reference),
                   "the sensor has a [[module]], which runs only if a plan is simulated or measured; use a sensor "
                   "without modules here");
  }
  return spec;
}

Result<SensorSpec> load_sensor_with_modules(std::string_view reference) {
  return load(ResourceKind::sensor, reference, parse_sensor);
}

Result<TemplateObserverSpec> load_observer(std::string_view reference) {
  auto spec = load(ResourceKind::observer, reference, parse_observer);
  if (spec && spec->eye) return fail_at(ErrorCode::invalid_input, std::string(reference), needs_display_here);
  return spec;
}

Result<TemplateObserverSpec> load_observer_at(std::string_view reference, const ViewedDisplay& display) {
  auto spec = load(ResourceKind::observer, reference, parse_observer);
  if (spec) spec->display = display;
  return spec;
}

Result<void> refuse_eye(const TemplateObserverSpec& observer, std::string_view work) {
  if (!observer.eye) return {};
  return fail_at(ErrorCode::invalid_input, "observer.name",
                 std::string(work) + " does not model the eye of observer " + observer.name +
                     " and its display; use an observer without an eye (hvs-1)");
}

Result<void> require_eye(const TemplateObserverSpec& observer, std::string_view origin) {
  if (observer.eye) return {};
  return fail_at(ErrorCode::invalid_input, std::string(origin),
                 "the observer has no eye; choose hvs-2, or an observer fitted from it");
}

Result<TargetPlate> load_plate(std::string_view reference) {
  return load(ResourceKind::plate, reference, parse_plate);
}

}  // namespace todbench
