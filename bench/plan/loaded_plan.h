// A plan and what it names, read once.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "acquisition/core/result.h"
#include "bench/plan/key_types.h"
#include "bench/plan/letterhead.h"
#include "bench/plan/plan.h"
#include "bench/plan/resources.h"
#include "hvs/observer/template_observer.h"
#include "sim_devices/sensor/sensor_spec.h"
#include "tod/instruments/instrument_table.h"
#include "tod/plate/target_plate.h"

namespace todbench {

/// The descriptions that a plan names, as their files say.
struct PlanParts {
  std::vector<TargetPlate> plates;  ///< in the order of the plan, each with a name of its own
  TemplateObserverSpec observer;
  SensorSpec sensor;                       ///< with its own microscan
  std::optional<TargetPlate> mtf_plate{};  ///< where [measures] asks for an MTF
  std::optional<TargetPlate> ctf_plate{};  ///< where it asks for a CTF
  InstrumentTable black_body{}, stage{};   ///< of a plan with a target of kind scpi; else whatever
  std::optional<Letterhead> letterhead{};  ///< where [report] names one
  /// The texts they were read from, by kind and reference.
  std::map<std::pair<ResourceKind, std::string>, Resource> sources{};
};

/// A plan that is valid, with the parts that it names: what every run, forecast and report begins with. Nothing of it
/// is read again. Immutable; threads may share it.
class LoadedPlan {
 public:
  /// Validates the plan and reads its parts through `find`. Errors: `invalid_input` about the key (validate(), or a
  /// part that is not found or wrong).
  [[nodiscard]] static Result<LoadedPlan> load(Plan plan, const ResourceFinder& find = find_resource);
  /// Of parts that have been read: those that the plan names. Errors: validate().
  [[nodiscard]] static Result<LoadedPlan> of(Plan plan, PlanParts parts);
  /// Another plan, of which only those parts are read that this one does not name.
  [[nodiscard]] Result<LoadedPlan> with(Plan plan, const ResourceFinder& find = find_resource) const;

  [[nodiscard]] const Plan& plan() const { return plan_; }
  [[nodiscard]] const std::vector<TargetPlate>& plates() const { return parts_.plates; }
  /// Every plate that a target has to be able to show: of the trials, of MTF and CTF.
  [[nodiscard]] std::vector<TargetPlate> shown_plates() const;
  [[nodiscard]] const TemplateObserverSpec& observer() const { return parts_.observer; }
  /// With the microscan of the plan.
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

/// As load_plan() and parse_plan(), with the parts.
[[nodiscard]] Result<LoadedPlan> read_plan(std::string_view reference, const ResourceFinder& find = find_resource);
[[nodiscard]] Result<LoadedPlan> read_plan(const Resource& resource, const std::filesystem::path& folder,
                                           const ResourceFinder& find = find_resource);

/// A plan that names a camera; `invalid_input` for one that does not.
[[nodiscard]] Result<LoadedPlan> read_camera_plan(std::string_view reference);

/// The plan with the files that it names as absolute paths; relative ones are relative to `folder`.
[[nodiscard]] Plan with_absolute_references(Plan plan, const std::filesystem::path& folder);

/// Reads the parts that keys of a type name in `plan` into `parts`; what cannot be used, by element of the list.
[[nodiscard]] std::vector<ValueMistake> read_parts(const KeyType& type, const Plan& plan, const ResourceFinder& find,
                                                   PlanParts& parts);

}  // namespace todbench
