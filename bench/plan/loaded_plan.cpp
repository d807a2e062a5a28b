// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/plan/loaded_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "acquisition/base/try.h"
#include "bench/plan/collimator.h"
#include "bench/plan/descriptions.h"
#include "bench/plan/instrument_description.h"
#include "bench/plan/plan_keys.h"
#include "sim_devices/sensor/effect_readout.h"

namespace todbench {
namespace {

/// Parses a description and keeps its text.
template <typename T>
Result<T> read_part(ResourceKind kind, const std::string& reference, const ResourceFinder& find, PlanParts& parts,
                    Result<T> (*parse)(const Resource&)) {
  TODBENCH_TRY(Resource resource, find(kind, reference));
  Result<T> part = parse(resource);
  parts.sources.insert_or_assign({kind, reference}, std::move(resource));
  return part;
}

template <typename T>
std::vector<ValueMistake> keep(Result<T> read, T& part) {
  if (!read) return {{std::nullopt, read.error().message}};
  part = *std::move(read);
  return {};
}

std::vector<ValueMistake> read_plates(const std::vector<std::string>& references, const ResourceFinder& find,
                                      PlanParts& parts) {
  std::vector<ValueMistake> mistakes;
  parts.plates.clear();
  for (std::size_t i = 0; i < references.size(); ++i) {
    const auto here = references.begin() + static_cast<std::ptrdiff_t>(i);
    // A duplicate in the list is reported as a duplicate, not as another plate with the same name.
    if (std::find(references.begin(), here, *here) != here) continue;
    Result<TargetPlate> plate = read_part(ResourceKind::plate, *here, find, parts, parse_plate);
    if (!plate) {
      mistakes.push_back({i, plate.error().message});
      continue;
    }
    if (plate->triangles.empty()) {
      mistakes.push_back({i, *here + ": the plate has no triangles, but trials need triangles"});
      continue;
    }
    for (const TargetPlate& other : parts.plates) {
      if (other.name != plate->name) continue;
      mistakes.push_back({i, *here + ": a second plate with the name '" + other.name + "'"});
    }
    parts.plates.push_back(*std::move(plate));
  }
  return mistakes;
}

const MeasurePlate& plate_of(PlateUse use) {
  return measure_plates[static_cast<std::size_t>(use)];
}

/// Returns whether the plan needs the part, for keys that name a single one.
bool is_asked_for(const ResourceKey& key, const Plan& plan) {
  if (key.kind == ResourceKind::plate) return plan.measures.*plate_of(key.use).requested;
  if (key.kind == ResourceKind::black_body || key.kind == ResourceKind::stage)
    return plan.target.kind == TargetKind::scpi;
  if (key.kind == ResourceKind::letterhead) return !plan.report.letterhead.empty();
  return true;
}

std::vector<ValueMistake> read_letterhead(const Plan& plan, const ResourceFinder& find, PlanParts& parts) {
  parts.letterhead.reset();
  if (!is_asked_for({ResourceKind::letterhead}, plan)) return {};
  return keep(read_part(ResourceKind::letterhead, plan.report.letterhead, find, parts, parse_letterhead),
              parts.letterhead.emplace());
}

/// Returns the reason why a plate cannot be used for a measure; empty if it can.
std::string unfit_for(PlateUse use, const TargetPlate& plate, const Plan& plan) {
  if (use == PlateUse::mrtd) {
    const auto pairs = bar_pairs(plate);
    if (pairs.empty())
      return "an MRTD needs groups of four bars and groups of five bars (bars = 5) that fill the same square";
    double widest_mm = 0;
    for (const BarPair& pair : pairs) widest_mm = std::max(widest_mm, pair.four.bar_mm);
    const double per_pitch = plan.target.distance_m * plan.camera.ifov_mrad / (2 * widest_mm);
    if (per_pitch <= mrtd_cut_per_pitch) return "";
    return fmt::format(
        "its widest bars, {:g} mm, have {:.3g} cycles per pixel at {:g} m: finer than the cut of an "
        "MRTD, half a cycle per pixel",
        widest_mm, per_pitch, plan.target.distance_m);
  }
  if (use == PlateUse::source_size && plate.rectangles.size() < 2)
    return "the plate has fewer than two rectangles, but the size-of-source effect compares square apertures";
  if (use == PlateUse::absolute)
    return plate.rectangles.size() == 1
               ? ""
               : "absolute temperatures need a plate with one rectangle that fills the picture";
  if (plate.rectangles.empty()) return "the plate has no rectangles, but an MTF or CTF needs straight edges";
  if (use == PlateUse::ctf && plate.bars.empty()) return "the plate has no bars, but a CTF needs groups of bars";
  return "";
}

std::vector<ValueMistake> read_measure_plate(PlateUse use, const Plan& plan, const ResourceFinder& find,
                                             PlanParts& parts) {
  const MeasurePlate& own = plate_of(use);
  std::optional<TargetPlate>& part = parts.*own.part;
  const std::string& reference = plan.measures.*own.reference;
  part.reset();
  if (!is_asked_for({ResourceKind::plate, use}, plan)) return {};
  Result<TargetPlate> plate = read_part(ResourceKind::plate, reference, find, parts, parse_plate);
  if (!plate) return {{std::nullopt, plate.error().message}};
  if (const std::string why = unfit_for(use, *plate, plan); !why.empty())
    return {{std::nullopt, reference + ": " + why}};
  for (std::size_t i = 0; i < parts.plates.size(); ++i) {
    if (parts.plates[i].name == plate->name && i < plan.target.plates.size() && plan.target.plates[i] != reference)
      return {{std::nullopt, reference + ": a plate of the trials has the same name, '" + plate->name + "'"}};
  }
  for (const auto& [other_use, measure] : {std::pair(PlateUse::mtf, "MTF"), std::pair(PlateUse::ctf, "CTF"),
                                           std::pair(PlateUse::source_size, "size-of-source effect")}) {
    const MeasurePlate& other = plate_of(other_use);
    const std::optional<TargetPlate>& shown = parts.*other.part;
    if (other_use < use && shown && shown->name == plate->name && plan.measures.*other.reference != reference)
      return {{std::nullopt,
               fmt::format("{}: the plate of the {} has the same name, '{}'", reference, measure, plate->name)}};
  }
  part = *std::move(plate);
  return {};
}

/// Reads an instrument table, if the plan needs it.
std::vector<ValueMistake> read_instrument(ResourceKind kind, const std::string& reference, const Plan& plan,
                                          const ResourceFinder& find, PlanParts& parts) {
  if (!is_asked_for({kind}, plan)) return {};
  const bool black_body = kind == ResourceKind::black_body;
  InstrumentTable& table = black_body ? parts.black_body : parts.stage;
  auto mistakes = keep(read_part(kind, reference, find, parts, parse_instrument), table);
  if (!mistakes.empty()) return mistakes;
  const auto expected = black_body ? InstrumentKind::black_body : InstrumentKind::stage;
  if (table.kind == expected) return {};
  return {{std::nullopt, reference + ": is of kind \"" + std::string(to_string(table.kind)) + "\", expected \"" +
                             std::string(to_string(expected)) + "\""}};
}

/// Reads the parts whose names differ between `plan` and `known`; all if `known` is null.
Result<void> read_changed(const Plan& plan, const Plan* known, const ResourceFinder& find, PlanParts& parts) {
  for (const PlanSection& section : plan_sections()) {
    for (const PlanKey& key : section.keys) {
      const auto* one = std::get_if<ResourceKey>(&key.type);
      if (one == nullptr && !std::holds_alternative<ResourcesKey>(key.type)) continue;
      if (known != nullptr && key.place.get(plan, 0) == key.place.get(*known, 0) &&
          (one == nullptr || is_asked_for(*one, plan) == is_asked_for(*one, *known)))
        continue;
      const auto mistakes = read_parts(key.type, plan, find, parts);
      if (!mistakes.empty()) return tl::unexpected(error_of({.at = {&section, &key, 0}, .mistake = mistakes.front()}));
    }
  }
  return {};
}

}  // namespace

Result<void> check_eye(const Plan& plan, const PlanParts& parts) {
  const auto judges = [](const ModulePlan& module) { return module.place == ModulePlace::observer; };
  if (std::ranges::any_of(plan.modules, judges)) {
    TODBENCH_TRY_VOID(refuse_eye(parts.observer, "a module in place of the observer"));
  }
  if (!parts.observer.eye || has_display(plan)) return {};
  return fail_at(ErrorCode::invalid_input, "observer.name",
                 "observer " + parts.observer.name +
                     " has an eye and needs a display: state its pixel pitch, viewing distance and luminance in "
                     "section [display] of the plan ('todbench judge' takes that of another plan with --display)");
}

namespace {

/// Features of a plan that need pixels as high as wide.
Result<void> check_pixel_shape(const Plan& plan, const PlanParts& parts) {
  const MeasuresPlan& measures = plan.measures;
  const std::pair<bool, std::string_view> features[] = {{parts.observer.eye.has_value(), "an observer with an eye"},
                                                        {measures.mtf, "mtf in [measures]"},
                                                        {measures.ctf, "ctf in [measures]"},
                                                        {measures.source_size, "source_size in [measures]"},
                                                        {measures.mrtd, "mrtd in [measures]"}};
  for (const auto& [used, name] : features) {
    if (!used) continue;
    TODBENCH_TRY_VOID(require_square_pixels(parts.sensor, name));
  }
  return {};
}

/// Returns the contradictions between parts and plan.
Result<void> fits_together(const Plan& plan, const PlanParts& parts) {
  TODBENCH_TRY_VOID(check_eye(plan, parts));
  TODBENCH_TRY_VOID(check_pixel_shape(plan, parts));
  constexpr double steepest = 0.5;  // motion of the target between two rows, in pitches
  const cv::Point2d slope = readout_slope(parts.sensor, plan.simulation.motion);
  if (std::hypot(slope.x, slope.y) <= steepest) return {};
  return fail(
      ErrorCode::invalid_input,
      "motion_mrad_s in [simulation]: the target moves by more than half a detector pitch between two rows of " +
          parts.sensor.name);
}

}  // namespace

std::vector<ValueMistake> read_parts(const KeyType& type, const Plan& plan, const ResourceFinder& find,
                                     PlanParts& parts) {
  const auto* const many = std::get_if<ResourcesKey>(&type);
  const ResourceKind kind = many != nullptr ? many->kind : std::get<ResourceKey>(type).kind;
  switch (kind) {
    case ResourceKind::plate:
      return many != nullptr ? read_plates(plan.target.plates, find, parts)
                             : read_measure_plate(std::get<ResourceKey>(type).use, plan, find, parts);
    case ResourceKind::observer:
      return keep(read_part(kind, plan.observer, find, parts, parse_observer), parts.observer);
    case ResourceKind::sensor:
      return keep(read_part(kind, plan.simulation.sensor, find, parts, parse_sensor), parts.sensor);
    case ResourceKind::black_body:
      return read_instrument(kind, plan.target.black_body_table, plan, find, parts);
    case ResourceKind::stage:
      return read_instrument(kind, plan.target.stage_table, plan, find, parts);
    case ResourceKind::letterhead:
      return read_letterhead(plan, find, parts);
    case ResourceKind::plan:
    case ResourceKind::atmosphere:
    case ResourceKind::scene:
    case ResourceKind::target:
    case ResourceKind::target_set:
      break;
  }
  return {};
}

std::vector<TargetPlate> LoadedPlan::shown_plates() const {
  std::vector<TargetPlate> plates = parts_.plates;
  for (const MeasurePlate& measure : measure_plates) {
    const std::optional<TargetPlate>& added = parts_.*measure.part;
    const auto there = [&](const TargetPlate& plate) { return plate.name == added->name; };
    if (added && std::none_of(plates.begin(), plates.end(), there)) plates.push_back(*added);
  }
  return plates;
}

LoadedPlan::LoadedPlan(Plan plan, PlanParts parts)
    : plan_(std::move(plan)), parts_(std::move(parts)), sensor_(parts_.sensor) {
  sensor_.microscan = plan_.simulation.microscan;
  plan_.camera.pixel_aspect = parts_.observer.sample_aspect = sensor_.pitch_aspect();
  if (plan_.target.collimator.stated()) {
    const SpectralBand band{sensor_.wavelength_min_um, sensor_.wavelength_max_um};
    plan_.target.collimator.transmission = mean_transmission(plan_.target.collimator, band);
    plan_.uncertainty = budget_with_collimator(plan_, band);
  }
  parts_.observer.display = parts_.observer.eye ? std::optional(plan_.display) : std::nullopt;
}

Result<LoadedPlan> LoadedPlan::load(Plan plan, const ResourceFinder& find) {
  TODBENCH_TRY_VOID(validate(plan));
  PlanParts parts;
  TODBENCH_TRY_VOID(read_changed(plan, nullptr, find, parts));
  TODBENCH_TRY_VOID(fits_together(plan, parts));
  return LoadedPlan(std::move(plan), std::move(parts));
}

Result<LoadedPlan> LoadedPlan::of(Plan plan, PlanParts parts) {
  TODBENCH_TRY_VOID(validate(plan));
  TODBENCH_TRY_VOID(check_eye(plan, parts));
  TODBENCH_TRY_VOID(check_pixel_shape(plan, parts));
  return LoadedPlan(std::move(plan), std::move(parts));
}

Result<LoadedPlan> LoadedPlan::with(Plan plan, const ResourceFinder& find) const {
  TODBENCH_TRY_VOID(validate(plan));
  PlanParts parts = parts_;
  TODBENCH_TRY_VOID(read_changed(plan, &plan_, find, parts));
  TODBENCH_TRY_VOID(fits_together(plan, parts));
  return LoadedPlan(std::move(plan), std::move(parts));
}

Plan with_absolute_references(Plan plan, const std::filesystem::path& folder) {
  for (const PlanSection& section : plan_sections()) {
    for (const PlanKey& key : section.keys) {
      if (!std::holds_alternative<ResourceKey>(key.type) && !std::holds_alternative<ResourcesKey>(key.type)) continue;
      KeyValue value = key.place.get(plan, 0);
      if (auto* one = std::get_if<std::string>(&value)) *one = absolute_reference(*one, folder);
      if (auto* many = std::get_if<std::vector<std::string>>(&value)) {
        for (std::string& reference : *many) reference = absolute_reference(reference, folder);
      }
      key.place.set(plan, 0, value);
    }
  }
  return plan;
}

Result<LoadedPlan> read_plan(std::string_view reference, const ResourceFinder& find) {
  TODBENCH_TRY(const Resource resource, find(ResourceKind::plan, reference));
  return read_plan(resource, is_file_reference(reference) ? std::filesystem::path(reference).parent_path() : "", find);
}

Result<LoadedPlan> read_camera_plan(std::string_view reference) {
  auto loaded = read_plan(reference);
  if (loaded && loaded->plan().camera.id.empty())
    return fail(ErrorCode::invalid_input,
                std::string(reference) +
                    ": the plan names no camera: state key 'id' in [camera]; todbench devices lists the cameras");
  return loaded;
}

Result<Plan> load_plan(std::string_view reference) {
  TODBENCH_TRY(const LoadedPlan loaded, read_plan(reference));
  return loaded.plan();
}

Result<Plan> parse_plan(const Resource& resource, const std::filesystem::path& folder) {
  TODBENCH_TRY(const LoadedPlan loaded, read_plan(resource, folder));
  return loaded.plan();
}

}  // namespace todbench
