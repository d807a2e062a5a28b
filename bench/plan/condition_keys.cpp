// SPDX-License-Identifier: GPL-3.0-or-later
// Plan keys of conditions of a run: warm-up of the camera, collimator before the target.
#include <utility>

#include "bench/plan/bench_checks.h"
#include "bench/plan/key_places.h"
#include "bench/plan/plan_sections.h"

namespace todbench {

namespace {

/// A key that only plans with the section have.
PlanKey optional_key(std::string_view name, KeyType type, std::string_view unit, std::string_view sentence,
                     KeyPlace place) {
  return {.name = name,
          .type = std::move(type),
          .unit = unit,
          .sentence = sentence,
          .place = std::move(place),
          .written_at_default = false};
}

}  // namespace

PlanSection warm_up_section() {
  const auto of = [](auto member) {
    return place_of(
        [](auto& plan, std::size_t) -> auto& { return plan.camera.warm_up; }, member);
  };
  return {.name = "camera.warm_up",
          .sentence = "Condition that the camera meets before a run. The log and the report state how it was met.",
          .keys = {optional_key("time_s", NumberKey{up_to_seconds}, "s",
                                "Time for which frames are taken before the run", of(&WarmUpPlan::time_s)),
                   optional_key("drift_k_per_min", NumberKey{NumberRange::between(0, 1000)}, "K/min",
                                "The run starts when the mean of the frames drifts more slowly, either way; 0: not "
                                "checked",
                                of(&WarmUpPlan::drift_k_per_min)),
                   optional_key("window_s", NumberKey{NumberRange::between(0.1, 3600)}, "s",
                                "Time over which the drift is computed", of(&WarmUpPlan::window_s)),
                   optional_key("timeout_s", NumberKey{NumberRange::between(0.1, 1e7)}, "s",
                                "The run ends with exit code 6 if the camera still drifts after this time",
                                of(&WarmUpPlan::timeout_s))}};
}

PlanSection collimator_section() {
  const auto of = [](auto member) {
    return place_of(
        [](auto& plan, std::size_t) -> auto& { return plan.target.collimator; }, member);
  };
  PlanSection section{
      .name = "target.collimator",
      .sentence = "A collimator between target and camera, in place of distance_m: it shows the plate at infinity.",
      .keys = {
          optional_key("focal_length_u_mm", NumberKey{not_negative}, "mm", "Standard uncertainty of the focal length",
                       of(&CollimatorPlan::focal_length_u_mm)),
          optional_key("transmission", NumberKey{NumberRange::above_to(0, 1)}, "",
                       "Share of a contrast that the collimator passes. With a table its mean replaces it",
                       of(&CollimatorPlan::transmission)),
          optional_key("transmission_u", NumberKey{share}, "", "Standard uncertainty of the transmission",
                       of(&CollimatorPlan::transmission_u)),
          optional_key("wavelengths_um", NumbersKey{NumberRange::between(0.1, 100), "wavelength", {}, MayBeEmpty::yes},
                       "um", "Wavelengths of a table of transmissions, in rising order",
                       of(&CollimatorPlan::wavelengths_um)),
          optional_key("transmissions", NumbersKey{share, "transmission", {}, MayBeEmpty::yes}, "",
                       "Transmission at each wavelength. The mean over the band of the sensor is used",
                       of(&CollimatorPlan::transmissions)),
          optional_key("mirror_temperature_c", OptionalNumberKey{NumberRange::between(-100, 200)}, "°C",
                       "Temperature of the mirrors; absent: that of the air",
                       of(&CollimatorPlan::mirror_temperature_c)),
          optional_key("blur_mrad", NumberKey{NumberRange::between(0, 1000)}, "mrad",
                       "Aberration: standard deviation of a normal blur per axis", of(&CollimatorPlan::blur_mrad)),
          optional_key("focal_length_mm", NumberKey{NumberRange::between(0, 1e5)}, "mm",
                       "Focal length. The angle of a triangle is its size over the focal length",
                       of(&CollimatorPlan::focal_length_mm))}};
  // The last key: a value out of its range is reported before a missing focal length.
  section.keys.back().check = check_focal_length;
  for (PlanKey& key : section.keys) {
    if (key.name == "transmissions") key.check = check_collimator_table;
  }
  return section;
}

}  // namespace todbench
