// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/presenters/device_plan.h"

#include <algorithm>
#include <vector>

#include "acquisition/base/try.h"
#include "acquisition/core/camera_id.h"
#include "bench/plan/descriptions.h"
#include "bench/plan/order.h"

namespace todbench {
namespace {

/// A shipped plan of the emulated laboratory, or an empty plan if it cannot be read.
Plan example(const char* name) {
  return load_plan(name).value_or(Plan{});
}
Plan demonstration() {
  return example("demo");
}

/// A plan without statements about a laboratory.
Plan unstated() {
  Plan plan;
  plan.name = "measurement";
  plan.target.kind = TargetKind::prompt;
  return plan;
}

/// Replaces a value that was not changed since it was filled in.
template <typename T>
void replace(T& value, const T& from, const T& to) {
  if (value == from) value = to;
}

/// The same for a list: of one that was changed in part, the rows that were filled in go. Not for limits: a list in
/// which one was changed is what the user demands.
template <typename T>
void replace_rows(std::vector<T>& rows, const std::vector<T>& from, const std::vector<T>& to) {
  if (rows == from)
    rows = to;
  else if (to.empty())
    std::erase_if(rows, [&](const T& row) { return std::ranges::find(from, row) != from.end(); });
}

void replace_words(Plan& plan, const Plan& from, const Plan& to) {
  replace(plan.description, from.description, to.description);
  replace(plan.unit, from.unit, to.unit);
}

void replace_laboratory(Plan& plan, const Plan& from, const Plan& to) {
  replace_words(plan, from, to);
  replace(plan.name, from.name, to.name);
  replace(plan.operator_name, from.operator_name, to.operator_name);
  replace(plan.place, from.place, to.place);
  replace(plan.target.plate_change_s, from.target.plate_change_s, to.target.plate_change_s);
  replace(plan.target.mounting_change_s, from.target.mounting_change_s, to.target.mounting_change_s);
  replace(plan.target.contrast_change_s, from.target.contrast_change_s, to.target.contrast_change_s);
  replace(plan.target.shift_change_s, from.target.shift_change_s, to.target.shift_change_s);
  replace(plan.limits.acuity, from.limits.acuity, to.limits.acuity);
  replace(plan.limits.measures, from.limits.measures, to.limits.measures);
  replace(plan.limits.zones, from.limits.zones, to.limits.zones);
  replace_rows(plan.uncertainty.rows, from.uncertainty.rows, to.uncertainty.rows);
}

/// Removes what an order states about a single unit. Customer, laboratory and method stay.
void forget_unit(OrderPlan& order) {
  for (std::string* text : {&order.report_number, &order.item, &order.item_condition, &order.received, &order.issued})
    text->clear();
  order.camera_temperature_c.reset();
}

Result<double> sensor_ifov_mrad(const std::string& name) {
  TODBENCH_TRY(auto sensor, load_sensor(name));
  return sensor.ifov_mrad() / sensor.microscan;
}

}  // namespace

Plan plan_for_camera(Plan plan, const std::string& id) {
  const Plan demo = demonstration();
  for (const Plan& from : {demo, example("acceptance")}) replace_laboratory(plan, from, unstated());
  if (plan.camera.id != id) {
    const CameraPlan before = plan.camera;
    const bool of_a_unit =
        !before.id.empty() && before.id != demo.camera.id && !has_scheme(before.id, camera_scheme::sim);
    if (of_a_unit) forget_unit(plan.order);
    plan.camera = {};
    plan.camera.reconnect_s = before.reconnect_s;
    plan.camera.nuc_interval_s = before.nuc_interval_s;
    plan.camera.nuc_wait_s = before.nuc_wait_s;
    plan.camera.id = id;
    plan.unit.clear();
  }
  const bool emulated = plan.target.black_body == demo.target.black_body && plan.target.stage == demo.target.stage;
  if (emulated) {
    plan.target.black_body.clear();
    plan.target.stage.clear();
  }
  if (plan.target.kind == TargetKind::scene || (plan.target.kind == TargetKind::scpi && emulated))
    plan.target.kind = TargetKind::prompt;
  return plan;
}

Plan plan_for_laboratory(Plan plan) {
  const Plan demo = demonstration();
  replace_laboratory(plan, unstated(), demo);
  plan.camera.id = demo.camera.id;
  plan.camera.ifov_mrad = sensor_ifov_mrad(plan.simulation.sensor).value_or(demo.camera.ifov_mrad);
  plan.target.kind = TargetKind::scpi;
  plan.target.black_body = demo.target.black_body;
  plan.target.stage = demo.target.stage;
  return plan;
}

Result<Plan> plan_for_sensor(Plan plan, const std::string& name) {
  TODBENCH_TRY(auto ifov_mrad, sensor_ifov_mrad(name));
  for (const Plan& from : {demonstration(), example("acceptance")}) replace_words(plan, from, Plan{});
  plan.camera.id = camera_id(camera_scheme::sim, name);
  plan.camera.ifov_mrad = ifov_mrad;
  plan.target.kind = TargetKind::scene;
  plan.target.black_body.clear();
  plan.target.stage.clear();
  plan.simulation.sensor = name;
  return plan;
}

}  // namespace todbench
