// SPDX-License-Identifier: GPL-3.0-or-later
// Order of the sections. A new key is a member in plan.h and a row in the file of its section.
#include "bench/plan/plan_sections.h"

namespace todbench {

const std::vector<PlanSection>& plan_sections() {
  static const std::vector<PlanSection> sections{
      about_section(),         camera_section(),         warm_up_section(),     collimator_section(),
      target_section(),        observer_section(),       simulation_section(),  schedule_section(),
      fit_section(),           measurement_section(),    measures_section(),    limits_section(),
      acuity_limits_section(), measure_limits_section(), zone_limits_section(), fleet_section(),
      uncertainty_section(),   budget_row_section(),     instrument_section(),  module_section(),
      motion_section(),        report_section(),         order_section(),       display_section()};
  return sections;
}

}  // namespace todbench
