// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/twin/background_twin_functions.h"

#include <cmath>
#include <optional>
#include <utility>

#include "bench/twin/twin_shapes.h"

namespace todbench {

TodCurve known_functions(const std::map<double, ProportionTable>& tables, const TodCurve& curve) {
  constexpr double nearby = 0.02;
  TodCurve known;
  for (const TodPoint& point : curve.points) {
    const auto table = tables.find(point.set_delta_t_k);
    if (table == tables.end()) continue;
    if (!(std::abs(point.delta_t_k / point.set_delta_t_k - 1) < nearby)) continue;
    TodPoint one;
    one.set_delta_t_k = point.set_delta_t_k;
    one.fit.twin_shape = TwinShapeUse{.table = table->second};
    known.points.push_back(std::move(one));
  }
  return known;
}

BackgroundTwinFunctions::BackgroundTwinFunctions(const Plan& plan, const ExperimentInputs& inputs)
    : made_([&plan, &inputs](std::stop_token stop) {
        return twin_tables(plan, inputs, std::nullopt, std::move(stop));
      }) {}

TodCurve BackgroundTwinFunctions::known_for(const TodCurve& curve, std::stop_token stop) {
  const auto& tables = made_.get(std::move(stop));
  return tables ? known_functions(*tables, curve) : TodCurve{};
}

}  // namespace todbench
