// SPDX-License-Identifier: GPL-3.0-or-later
// Plan with the descriptions that it names, read once.
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "acquisition/base/result.h"
#include "bench/plan/key_types.h"
#include "bench/plan/letterhead.h"
#include "bench/plan/plan.h"
#include "bench/plan/resources.h"
#include "hvs/observer/template_observer.h"
#include "sim_devices/sensor/sensor_spec.h"
#include "tod/instruments/instrument_table.h"
#include "tod/plate/target_plate.h"

namespace todbench {

/// Descriptions that a plan names, as read from their files.
struct PlanParts {
  std::vector<TargetPlate> plates;  ///< plates in the order of the plan, with unique names
  TemplateObserverSpec observer;
  SensorSpec sensor;                          ///< sensor with the microscan of its file
  std::optional<TargetPlate> mtf_plate{};     ///< present if [measures] requests an MTF
  std::optional<TargetPlate> ctf_plate{};     ///< present if [measures] requests a CTF
  std::optional<TargetPlate> source_plate{};  ///< present if [measures] requests the size-of-source effect
  std::optional<TargetPlate> open_plate{};    ///< present if [measures] requests absolute temperatures
  std::optional<TargetPlate> mrtd_plate{};    ///< present if [measures] requests an MRTD
  InstrumentTable black_body{}, stage{};      ///< only for targets of kind scpi; otherwise unspecified
  std::optional<Letterhead> letterhead{};     ///< present if [report] names one
  /// Source texts by kind and reference.
  std::map<std::pair<ResourceKind, std::string>, Resource> sources{};
};

/// Plate of a physical measure: whether the plan requests the measure, name or file of its plate, and the plate itself.
struct MeasurePlate {
  bool MeasuresPlan::*requested;
  std::string MeasuresPlan::*reference;
  std::optional<TargetPlate> PlanParts::*part;
};
/// Plates of the measures, in the order of PlateUse.
inline constexpr std::array<MeasurePlate, 5> measure_plates{{
    {&MeasuresPlan::mtf, &MeasuresPlan::mtf_plate, &PlanParts::mtf_plate},
    {&MeasuresPlan::ctf, &MeasuresPlan::ctf_plate, &PlanParts::ctf_plate},
    {&MeasuresPlan::source_size, &MeasuresPlan::source_size_plate, &PlanParts::source_plate},
    {&MeasuresPlan::absolute, &MeasuresPlan::absolute_plate, &PlanParts::open_plate},
    {&MeasuresPlan::mrtd, &MeasuresPlan::mrtd_plate, &PlanParts::mrtd_plate},
}};

/// Valid plan with the parts that it names. Every run, forecast and report starts from this object. No file is read
/// again later. Immutable; threads may share it.
class LoadedPlan {
 public:
  /// Validates the plan and reads its parts with `find`. Errors: `invalid_input` about the key (validate(); part not
  /// found or invalid).
  [[nodiscard]] static Result<LoadedPlan> load(Plan plan, const ResourceFinder& find = find_resource);
  /// Combines a plan with parts already read, which must be the parts that the plan names. Errors: those of validate().
  [[nodiscard]] static Result<LoadedPlan> of(Plan plan, PlanParts parts);
  /// Loads a different plan and reads only the parts that this plan does not have.
  [[nodiscard]] Result<LoadedPlan> with(Plan plan, const ResourceFinder& find = find_resource) const;

  [[nodiscard]] const Plan& plan() const { return plan_; }
  [[nodiscard]] const std::vector<TargetPlate>& plates() const { return parts_.plates; }
  /// Returns every plate that the target must be able to show: the plates of the trials, and the plates of the
  /// requested measures (MTF, CTF, size-of-source effect, absolute temperatures, MRTD).
  [[nodiscard]] std::vector<TargetPlate> shown_plates() const;
  [[nodiscard]] const TemplateObserverSpec& observer() const { return parts_.observer; }
  /// Returns the sensor with the microscan of the plan.
  [[nodiscard]] const SensorSpec& sensor() const { return sensor_; }
  [[nodiscard]] const PlanParts& parts() const { return parts_; }

 private:
  friend Result<LoadedPlan> read_plan(const Resource& resource, const std::filesystem::path& folder,
                                      const ResourceFinder& find);
  LoadedPlan(Plan plan, PlanParts parts);
  Plan plan_;
  PlanParts parts_;
  SensorSpec sensor_;
};

/// Read a plan as load_plan() and parse_plan() do, and also its parts.
[[nodiscard]] Result<LoadedPlan> read_plan(std::string_view reference, const ResourceFinder& find = find_resource);
[[nodiscard]] Result<LoadedPlan> read_plan(const Resource& resource, const std::filesystem::path& folder,
                                           const ResourceFinder& find = find_resource);

/// Reads a plan and requires a camera id. Errors: `invalid_input` (also for a plan without a camera).
[[nodiscard]] Result<LoadedPlan> read_camera_plan(std::string_view reference);

/// Returns the plan with absolute paths of the files that it names; relative paths are relative to `folder`.
[[nodiscard]] Plan with_absolute_references(Plan plan, const std::filesystem::path& folder);

/// Fails if the observer has an eye and the plan either has no display or has a module in place of the observer.
[[nodiscard]] Result<void> check_eye(const Plan& plan, const PlanParts& parts);

/// Reads into `parts` the descriptions that `plan` names by keys of this type. Returns the mistakes by element of the
/// list.
[[nodiscard]] std::vector<ValueMistake> read_parts(const KeyType& type, const Plan& plan, const ResourceFinder& find,
                                                   PlanParts& parts);

}  // namespace todbench
