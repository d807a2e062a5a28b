// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/report/report_csv.h"

#include <array>
#include <optional>
#include <string_view>

#include "bench/judgement/demand_kinds.h"
#include "bench/plan/quantity.h"
#include "bench/text/spreadsheet.h"
#include "bench/text/text.h"
#include "tod/psychometric/acuity.h"

namespace todbench {
namespace {

struct Row {
  std::string section, name;
  std::optional<double> set_delta_t_k{};
  std::optional<double> value{};
  Interval interval{};
  std::optional<int> interval_percent{};
  std::optional<double> limit{};
  std::string unit{};
  std::string decision{};
  std::string text{};
  std::string definition{};
};

std::string field(const std::optional<double>& number) {
  return number ? number_text(*number) : "";
}

void add(std::string& table, const Row& row) {
  const std::array fields{spreadsheet_field(row.section),
                          spreadsheet_field(row.name),
                          field(row.set_delta_t_k),
                          field(row.value),
                          field(row.interval.low),
                          field(row.interval.high),
                          row.interval_percent ? std::to_string(*row.interval_percent) : std::string(),
                          field(row.limit),
                          spreadsheet_field(row.unit),
                          spreadsheet_field(row.decision),
                          spreadsheet_field(row.text),
                          spreadsheet_field(row.definition)};
  for (const std::string& text : fields) table += (&text == &fields.front() ? "" : ",") + text;
  table += "\n";
}

void add_session(std::string& table, const ReportData& data) {
  const auto text = [&](std::string name, const std::string& said) {
    add(table, {.section = "session", .name = std::move(name), .text = said});
  };
  text("session", data.session);
  text("description", data.description);
  text("operator", data.operator_name);
  text("place", data.place);
  text("started", data.started);
  text("finished", data.finished);
  for (const auto& [name, value] : data.conditions) text(name, value);
  if (data.camera) {
    text("camera_id", data.camera->id);
    text("camera_vendor", data.camera->vendor);
    text("camera_model", data.camera->model);
    text("camera_serial", data.camera->serial);
    text("camera_firmware", data.camera->firmware);
  }
  text("observer", data.observer);
  text("manifest_sha256", data.manifest_sha256);
  if (data.interrupted) text("ended_early", *data.interrupted);
  for (const std::string& file : data.accepted_changes) text("changed_file", file);
}

void add_verdict(std::string& table, const ReportData& data) {
  if (report_verdict(data) == ReportVerdict::changed) {
    add(table, {.section = "verdict",
                .name = "decision",
                .decision = "none",
                .text = "files of the session were changed after the run"});
    return;
  }
  if (!data.verdict) return;
  add(table, {.section = "verdict",
              .name = "decision",
              .decision = std::string(to_string(data.verdict->decision)),
              .text = data.verdict->reason});
  add(table, {.section = "verdict", .name = "rule", .text = std::string(to_string(data.verdict->rule))});
  add(table, {.section = "verdict", .name = "judged", .text = std::string(to_string(data.verdict->judged))});
  for (const Demand& demand : data.verdict->demands) {
    add(table, {.section = "demand",
                .name = std::string(to_string(demand.kind)),
                .set_delta_t_k = demand.delta_t_k,
                .value = demand.result,
                .interval = demand.interval,
                .interval_percent = demand.interval_percent,
                .limit = demand.limit,
                .unit = std::string(row_of(demand.kind).unit),
                .decision = std::string(to_string(demand.decision)),
                .text = demand.reason});
  }
}

void add_bars(std::string& table, const std::string& section, const BarsCtf& group) {
  const auto phase = [&](const std::string& name, const Estimate& found) {
    add(table, {.section = section,
                .name = "ctf_" + name + "_" + std::string(to_string(group.axis)) + " at " +
                        number_text(group.frequency_per_pitch) + " cycles per pitch, " + group.group,
                .value = found.value,
                .interval = {found.low, found.high},
                .interval_percent = 95,
                .unit = "1"});
  };
  phase("best", group.best), phase("mean", group.mean), phase("worst", group.worst);
}

void add_measures(std::string& table, const std::string& section, const std::optional<MeasureLines>& side) {
  if (!side) return;
  for (const MeasureLine& line : side->lines) {
    const bool bounded = line.ci95.low || line.ci95.high;
    const Quantity* quantity = find_quantity(line.measure);
    add(table, {.section = section,
                .name = line.measure,
                .value = line.value,
                .interval = line.ci95,
                .interval_percent = bounded ? std::optional(95) : std::nullopt,
                .unit = line.unit,
                .text = line.conditions,
                .definition = quantity == nullptr ? std::string() : std::string(quantity->definition)});
  }
  if (side->ctf) {
    for (const BarsCtf& group : side->ctf->bars.groups) add_bars(table, section, group);
  }
  if (!side->mtf) return;
  for (const EdgeMtf& edge : side->mtf->edges) {
    for (std::size_t i = 0; i < edge.mtf.size(); ++i) {
      add(table, {.section = section,
                  .name = "mtf_" + std::string(to_string(edge.axis)) + " at " +
                          number_text(edge.frequency_per_pitch[i]) + " cycles per pitch, " + edge.place,
                  .value = edge.mtf[i],
                  .interval = {edge.low[i] > 0 ? std::optional(edge.low[i]) : std::nullopt, edge.high[i]},
                  .interval_percent = 95,
                  .unit = "1"});
    }
  }
}

void add_curve(std::string& table, const std::string& section, const std::optional<TodCurve>& curve) {
  if (!curve) return;
  for (const TodPoint& point : curve->points) {
    const std::string verdict(to_string(point.fit.verdict));
    add(table, {.section = section,
                .name = "delta_t_k",
                .set_delta_t_k = point.set_delta_t_k,
                .value = point.delta_t_k,
                .unit = "K"});
    add(table, {.section = section,
                .name = "s75_mrad",
                .set_delta_t_k = point.set_delta_t_k,
                .value = stated_threshold(point.fit),
                .interval = point.fit.ci95,
                .interval_percent = 95,
                .unit = "mrad",
                .decision = verdict});
    add(table, {.section = section,
                .name = "acuity_per_mrad",
                .set_delta_t_k = point.set_delta_t_k,
                .value = stated_acuity_per_mrad(point.fit),
                .interval = acuity_interval(point.fit.ci95),
                .interval_percent = 95,
                .unit = "1/mrad",
                .decision = verdict});
    add(table, {.section = section, .name = "trials", .set_delta_t_k = point.set_delta_t_k, .value = point.fit.trials});
  }
}

/// Adds the expanded intervals; the statistical ones are in the rows of the curve.
void add_uncertainty(std::string& table, const std::optional<CurveUncertainty>& uncertainty) {
  if (!uncertainty) return;
  for (const PointUncertainty& point : uncertainty->points) {
    const auto interval = [&](std::string name, const Interval& found, std::string unit) {
      add(table, {.section = "uncertainty",
                  .name = std::move(name),
                  .set_delta_t_k = point.set_delta_t_k,
                  .interval = found,
                  .interval_percent = 95,
                  .unit = std::move(unit)});
    };
    interval("s75_expanded_mrad", point.expanded_mrad, "mrad");
    interval("acuity_expanded_per_mrad", acuity_interval(point.expanded_mrad), "1/mrad");
    for (const AppliedRow& row : point.rows) {
      add(table, {.section = "uncertainty",
                  .name = row.row.name,
                  .set_delta_t_k = point.set_delta_t_k,
                  .value = row.contribution,
                  .text = row.row.certificate});
    }
  }
  for (const std::string& name : uncertainty->not_stated)
    add(table, {.section = "uncertainty", .name = name, .text = "not stated"});
}

void add_comparison(std::string& table, const std::optional<Comparison>& comparison) {
  if (!comparison) return;
  for (const ComparisonPoint& point : comparison->points) {
    add(table, {.section = "comparison",
                .name = "acuity_ratio",
                .set_delta_t_k = point.set_delta_t_k,
                .value = point.ratio,
                .interval = point.ratio_ci95,
                .interval_percent = 95,
                .decision = std::string(to_string(point.verdict))});
    if (point.paired) {
      add(table, {.section = "comparison",
                  .name = "acuity_ratio_paired",
                  .set_delta_t_k = point.set_delta_t_k,
                  .value = point.paired->ratio,
                  .interval = point.paired->ci95,
                  .interval_percent = 95,
                  .decision = std::string(to_string(point.paired->verdict))});
    }
    add(table, {.section = "comparison",
                .name = "equivalence_margin_percent",
                .set_delta_t_k = point.set_delta_t_k,
                .value = point.margin_percent,
                .unit = "%"});
  }
}

void add_frames(std::string& table, const ReportData& data) {
  const auto count = [&](const std::string& name, double frames) {
    add(table, {.section = "frames", .name = name, .value = frames});
  };
  count("used", static_cast<double>(data.frames_used));
  count("lost", static_cast<double>(data.frames_lost));
  for (const auto& [reason, frames] : data.frames_rejected) count("rejected: " + reason, static_cast<double>(frames));
}

}  // namespace

std::string report_csv(const ReportData& data) {
  std::string table =
      "section,name,set_delta_t_k,value,low,high,interval_percent,limit,unit,decision,text,definition\n";
  add_session(table, data);
  add_verdict(table, data);
  add_curve(table, "measured", data.measured);
  add_curve(table, "simulated", data.simulated);
  add_curve(table, "human", data.human);
  if (data.measures) {
    add_measures(table, "measures", data.measures->main);
    add_measures(table, "measures_twin", data.measures->twin);
  }
  add_comparison(table, data.comparison);
  add_frames(table, data);
  add_uncertainty(table, data.uncertainty);
  return table;
}

}  // namespace todbench
