// SPDX-License-Identifier: GPL-3.0-or-later
// Physical measures of a session: measures.json, and key "measures" of the JSON output.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "acquisition/base/result.h"
#include "bench/judgement/verdict.h"
#include "bench/session/pixel_record.h"
#include "bench/text/json.h"
#include "tod/camera_measures/camera_measures.h"

namespace todbench {

/// Value of a measure with its interval and conditions.
struct MeasureLine {
  std::string measure;  ///< "netd", "noise_tvh", "transfer_slope", ...
  std::string unit;
  std::optional<double> value{};
  Interval ci95{};
  std::string conditions{};
  /// Interval expanded by the uncertainty budget; empty if no row of the budget applies to this measure.
  std::optional<Interval> expanded{};
};

/// Returns a line in the unit of the quantity (table of quantities). `name`: name of the quantity, with its position if
/// it has one: "mtf_x (corner)".
[[nodiscard]] MeasureLine measure_line(std::string name, std::optional<double> value, const Interval& ci95,
                                       std::string conditions);

/// Observed plate, plate according to the sensor model, and their difference: grey PNG files in base64, all of the same
/// part of the picture.
struct PlatePanels {
  int width = 0, height = 0;  ///< size of each picture in pixels
  std::string seen, expected, difference;
  double black_k = 0, white_k = 0;  ///< grey scale of the first two pictures
  double difference_k = 0;          ///< grey scale of the difference: black at -difference_k, white at +difference_k
  /// Outlines of the detected shapes, in pixels of the panels (pixel centres at integers).
  std::vector<Polygon> outlines;
};

/// All measures of one camera, and the reasons for missing measures.
struct MeasureLines {
  std::vector<MeasureLine> lines;
  // Results for figures and tables. After measure_lines() the results are complete. After measures_from() they contain
  // only the numbers that figures and tables show.
  std::optional<MtfMeasure> mtf{};
  std::optional<CtfMeasure> ctf{};
  std::optional<SourceSizeMeasure> source{};
  std::optional<MrtdMeasure> mrtd{};
  std::optional<AbsoluteMeasure> absolute{};
  std::optional<LatencyMeasure> latency{};
  std::optional<GainControlMeasure> gain_control{};
  std::optional<TransferMeasure> transfer{};
  std::optional<GeometryMeasure> geometry{};
  std::optional<DriftMeasure> drift{};
  std::optional<ResponseMeasure> response{};
  std::optional<PlatePanels> picture{};
  std::vector<PixelMap> maps{};
  std::vector<std::string> reasons;
};
/// Returns the lines of all measures that were taken, their complete results, and the reasons for missing measures.
[[nodiscard]] MeasureLines measure_lines(const CameraMeasures& measures);

/// Returns the name, value and interval of each line, for JudgementInput::measures.
[[nodiscard]] std::vector<MeasuredQuantity> quantities_of(const MeasureLines& lines);

/// Measures of a session: of the camera (or of the simulated sensor alone) and of the twin.
struct SessionMeasures {
  std::optional<MeasureLines> main;
  std::optional<MeasureLines> twin;
};

/// Returns {"main": {"quantities": [...], "noise": {...}, "transfer": {...}, "geometry": {...}, "drift": {...},
/// "response": {...}, "pixels": {...}, "mtf": {...}, "ctf": {...}, "source_size": {...}, "absolute": {...}, "timing":
/// {...}, "latency": {...}, "mrtd": {...}, "gain_control": {...}, "maps": [...], "picture": {...}, "reasons": [...]},
/// "twin": the same or null}.
[[nodiscard]] Json measures_json(const std::optional<CameraMeasures>& main, const std::optional<CameraMeasures>& twin);
/// Returns the object of measures_json() as the content of the file measures.json. Errors: `internal` with the key if a
/// number is not finite.
[[nodiscard]] Result<Json> measures_record(const std::optional<CameraMeasures>& main,
                                           const std::optional<CameraMeasures>& twin);
/// Returns the record of one camera as "main", with quantities, maps and reasons only. Errors: as the overload above.
[[nodiscard]] Result<Json> measures_record(const MeasureLines& main);
/// Parses a record. Errors: `invalid_input` with the key (incomplete record, wrong type).
[[nodiscard]] Result<SessionMeasures> measures_from(const Json& record);

}  // namespace todbench
