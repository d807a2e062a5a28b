// SPDX-License-Identifier: GPL-3.0-or-later
// Acceptance report: one self-contained page made from values.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "acquisition/core/frame_source.h"
#include "bench/judgement/acuity_uncertainty.h"
#include "bench/judgement/verdict.h"
#include "bench/plan/letterhead.h"
#include "bench/plan/order.h"
#include "bench/report/accuracy_bill.h"
#include "bench/report/document.h"
#include "bench/report/plot.h"
#include "bench/session/bars_people.h"
#include "bench/session/display_record.h"
#include "bench/session/human_record.h"
#include "bench/session/measures_record.h"
#include "bench/session/provenance.h"
#include "bench/session/signature.h"
#include "hvs/eye/viewed_display.h"
#include "sim_devices/prediction/cost_frontier.h"
#include "sim_devices/sensor/sensor_plan.h"
#include "sim_devices/sensor/sensor_spec.h"
#include "tod/comparison/comparison.h"
#include "tod/measurement/measurement.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {

/// Verdict at the top of a report. A report only shows the decisions that the session contains. The verdict of an
/// interrupted run or of a run without limits is never "pass".
enum class ReportVerdict {
  pass,          ///< every limit is met
  fail,          ///< a limit is not met
  inconclusive,  ///< no limit is violated, at least one is undecided
  interrupted,   ///< the run ended early and no limit is violated
  not_judged,    ///< the plan has no limits
  changed,       ///< files of the session were changed after the run
};

/// Content of a report. Texts are plain; empty texts and absent values are shown as a dash with the reason. Times are
/// ISO 8601 with zone.
struct ReportData {
  std::string title = "TOD acceptance report";
  std::string session;      ///< unique name of the session folder
  std::string description;  ///< description of the plan
  std::string started, finished;
  std::string operator_name, place;
  /// Name with unit, and value: customer, lens, room temperature ...
  std::vector<std::pair<std::string, std::string>> conditions;

  std::optional<SourceInfo> camera;  ///< unit under test, as read from the device; empty: simulation only
  /// Temperature scale of the camera in words; empty: description from `camera`.
  std::string temperature_scale;
  double distance_m = 0;          ///< from entrance pupil to plate, or focal length of a collimator; 0: not stated
  bool collimated = false;        ///< the plate is behind a collimator
  double ifov_mrad = 0;           ///< 0: not stated
  double air_temperature_c = 20;  ///< air temperature of the plan
  std::optional<ViewedDisplay> display{};  ///< display of the plan; empty: none
  std::string target;                      ///< instruments with serial numbers
  std::vector<TargetPlate> plates;         ///< plates in identity mounting
  std::vector<SetUpRecord> set_ups;
  std::vector<Presentation> presentations;  ///< presentations of the camera, or of the simulation without a camera
  std::string observer;                     ///< name and version

  FitOptions fit;
  std::optional<TodCurve> measured;  ///< curve of the camera
  std::optional<TodCurve> simulated;
  std::optional<TodCurve> human;         ///< curve of the first person, from answers to patches of the camera's frames
  std::vector<PersonRecord> people;      ///< all people, without their trials and pictures
  std::vector<BarsSitting> bars_people;  ///< answers of people to the bars of the camera
  std::optional<Comparison> comparison;  ///< A is measured, B is simulated

  std::optional<SessionMeasures> measures;  ///< physical measures; empty: not requested

  /// Limits of the acuity and thresholds at the display. Neither affects the verdict.
  std::optional<DisplayRecord> at_display;

  /// Uncertainty of the measured curve, or of the curve of a simulation alone.
  std::optional<CurveUncertainty> uncertainty;

  std::optional<OrderPlan> order;  ///< order of the test; empty: not stated

  std::optional<Verdict> verdict;  ///< verdict of the session

  std::optional<SensorSpec> simulated_sensor;
  SensorPlan plan;                   ///< effects of the simulated sensor
  std::optional<CostFrontier> cost;  ///< time cost of accuracy; empty: not measured, no section

  double wall_s = 0;      ///< duration of the run with its physical measures, without the twin; 0: not stated
  double measures_s = 0;  ///< part of wall_s: physical measures; 0: none, or not stated
  std::optional<TimeForecast> forecast{};  ///< forecast of the plan; empty: no comparable forecast
  double twin_s = 0;                       ///< duration of the simulation of the twin; 0: not stated
  std::uint64_t frames_used = 0;
  std::map<std::string, std::uint64_t> frames_rejected;  ///< by reason
  std::uint64_t frames_lost = 0;
  double temporal_noise_k = 0;  ///< temporal noise of a pixel; 0: not measured

  std::optional<Letterhead> letterhead;  ///< letterhead of the laboratory; empty: default layout

  std::vector<std::pair<std::string, std::string>> provenance;  ///< versions, seeds, host
  std::string manifest_sha256;                ///< digest of the manifest that confirms these data; empty: none
  std::vector<std::string> accepted_changes;  ///< files of the session that were changed after the run
  bool cut_off = false;                       ///< the run wrote no manifest
  std::optional<ReportRevision> revision;     ///< revision of the report of a signed session; empty: first report
  std::vector<std::string> notes;
  std::optional<std::string> interrupted;   ///< reason for an early end of the run
  std::vector<Interruption> interruptions;  ///< camera losses after which the run continued
};

/// Returns the verdict to show: the decision of the session's verdict, with three exceptions. If files were changed,
/// the result is `changed`. For an interrupted run, the result is `fail` if the run failed, otherwise `interrupted`.
/// For a pass without limits, or if there is no verdict, the result is `not_judged`.
[[nodiscard]] ReportVerdict report_verdict(const ReportData& data);

/// Returns the TOD curve of the report.
[[nodiscard]] Plot tod_plot(const ReportData& data);
/// Returns one plot of psychometric functions per contrast.
[[nodiscard]] std::vector<Plot> psychometric_plots(const ReportData& data);
/// Returns plots of the psychometric functions of person and model; empty without a person.
[[nodiscard]] std::vector<Plot> human_plots(const ReportData& data);

/// Returns the bill of the run; empty if it has no curve or no time.
[[nodiscard]] std::optional<AccuracyBill> bill_of(const ReportData& data);

/// Returns the report as a document for page and PDF. A pure function.
[[nodiscard]] Document report_document(const ReportData& data);

/// Returns render_html() of the report.
[[nodiscard]] std::string render_report(const ReportData& data);

}  // namespace todbench
