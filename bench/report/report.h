// The acceptance report: one self-contained page made from values.
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
#include "bench/report/document.h"
#include "bench/report/plot.h"
#include "bench/session/measures_record.h"
#include "bench/session/signature.h"
#include "sim_devices/prediction/cost_frontier.h"
#include "sim_devices/sensor/sensor_plan.h"
#include "sim_devices/sensor/sensor_spec.h"
#include "tod/comparison/comparison.h"
#include "tod/measurement/measurement.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {

/// What stands over a report: its verdict, as decided elsewhere. The report shows decisions, it makes none. A run that
/// was interrupted, or without limits, does not say "pass".
enum class ReportVerdict {
  pass,          ///< every limit is met
  fail,          ///< a limit is not met
  inconclusive,  ///< no limit is violated, but one is not decided
  interrupted,   ///< the run ended early and no limit is violated
  not_judged,    ///< no limits were asked for
  changed,       ///< files of the session are not those that the run wrote
};

/// Everything in a report. Texts are plain; empty texts and missing values appear as a dash with the reason. Times are
/// ISO 8601 with zone.
struct ReportData {
  std::string title = "TOD acceptance report";
  std::string session;      ///< unique name of the session folder
  std::string description;  ///< of the plan
  std::string started, finished;
  std::string operator_name, place;
  std::vector<std::pair<std::string, std::string>>
      conditions;  ///< name with unit, value: customer, lens, room temperature, ...

  std::optional<SourceInfo> camera;  ///< unit under test, as read from the device; nothing: only a simulation
  std::string temperature_scale;     ///< of the camera, in words; empty: as the scale in `camera` describes itself
  double distance_m = 0;             ///< entrance pupil to plate; 0: not stated
  double ifov_mrad = 0;              ///< 0: not stated
  std::string target;                ///< instruments with serial numbers
  std::vector<TargetPlate> plates;   ///< in identity mounting
  std::vector<SetUpRecord> set_ups;
  std::vector<Presentation> presentations;  ///< of the camera, or of the simulation where there is none
  std::string observer;                     ///< name and version

  FitOptions fit;
  std::optional<TodCurve> measured;  ///< by the camera
  std::optional<TodCurve> simulated;
  std::optional<TodCurve> human;         ///< a person's answers to patches of the camera's frames
  std::optional<Comparison> comparison;  ///< A is measured, B is simulated

  std::optional<SessionMeasures> measures;  ///< physical; nothing: none was asked for

  std::optional<CurveUncertainty> uncertainty;  ///< of the measured curve, or of the simulated one alone

  std::optional<Verdict> verdict;  ///< of the session

  std::optional<SensorSpec> simulated_sensor;
  SensorPlan plan;                   ///< of the simulated sensor
  std::optional<CostFrontier> cost;  ///< what accuracy costs in time; nothing: not measured, and no section

  std::uint64_t frames_used = 0;
  std::map<std::string, std::uint64_t> frames_rejected;  ///< by reason
  std::uint64_t frames_lost = 0;
  double temporal_noise_k = 0;  ///< per pixel; 0: not measured

  std::optional<Letterhead> letterhead;  ///< of the laboratory; nothing: the report as it is

  std::vector<std::pair<std::string, std::string>> provenance;  ///< versions, seeds, host
  std::string manifest_sha256;                ///< of the manifest that vouches for all this; empty: there is none
  std::vector<std::string> accepted_changes;  ///< files of the session that are not those that the run wrote
  bool cut_off = false;                       ///< the run wrote no manifest
  std::optional<ReportRevision> revision;     ///< of the report of a signed session; nothing: the first report
  std::vector<std::string> notes;
  std::optional<std::string> interrupted;   ///< why the run ended early
  std::vector<Interruption> interruptions;  ///< losses of the camera after which the run went on
};

/// The verdict's decision; of an interrupted run only a failure; not_judged in place of a pass without limits; of
/// changed files none.
[[nodiscard]] ReportVerdict report_verdict(const ReportData& data);

/// The TOD curve of the report, and one psychometric function per contrast.
[[nodiscard]] Plot tod_plot(const ReportData& data);
[[nodiscard]] std::vector<Plot> psychometric_plots(const ReportData& data);
/// Those of the person beside the model; none without a person.
[[nodiscard]] std::vector<Plot> human_plots(const ReportData& data);

/// The report as a value, which page and PDF show. A pure function.
[[nodiscard]] Document report_document(const ReportData& data);

/// render_html() of the report.
[[nodiscard]] std::string render_report(const ReportData& data);

}  // namespace todbench
