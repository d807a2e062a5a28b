// Physical measures of a session: measures.json, and the key "measures" on standard output.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "acquisition/core/result.h"
#include "bench/judgement/verdict.h"
#include "bench/session/pixel_record.h"
#include "bench/text/json.h"
#include "tod/camera_measures/camera_measures.h"

namespace todbench {

/// One number with what has to stand beside it.
struct MeasureLine {
  std::string measure;  ///< "netd", "noise_tvh", "transfer_slope", ...
  std::string unit;
  std::optional<double> value{};
  Interval ci95{};
  std::string conditions{};
  /// With what the budget states of the bench; nothing: the budget states nothing of it, or it is not this measure's.
  std::optional<Interval> expanded{};
};

/// The MTF of every edge, for figures.
struct MtfCurves {
  double pitch_mrad = 0;
  std::vector<EdgeMtf> edges;
};

/// The CTF of every group of bars, for figures.
struct CtfGroups {
  double pitch_mrad = 0;
  std::vector<BarsCtf> groups;
};

/// Signal transfer, for figures.
struct TransferCurve {
  std::vector<TransferStep> steps;
  double slope = 0, offset_k = 0;
};

/// What is left of steps of the target, for figures.
struct ResponseCurve {
  double time_constant_s = 0;
  std::vector<StepPoint> points;
};

/// Where the triangles lie beside the fitted lens, for figures.
struct GeometryMap {
  double width = 0, height = 0;  ///< of the picture, in pixels
  std::vector<GeometryPlace> places;
};

/// The plate as it was seen, as the sensor model makes it, and the difference: grey PNG files as base64, of the same
/// part of the picture.
struct PlatePanels {
  int width = 0, height = 0;  ///< pixels of each
  std::string seen, expected, difference;
  double black_k = 0, white_k = 0;  ///< of the first two
  double difference_k = 0;          ///< of the third: black at minus, white at plus this
  std::vector<Polygon> outlines;    ///< of what was found, in pixels of the panels, centres at whole numbers
};

/// Everything that was measured of one camera, and why something was not.
struct MeasureLines {
  std::vector<MeasureLine> lines;
  std::optional<MtfCurves> mtf{};
  std::optional<CtfGroups> ctf{};
  std::optional<TransferCurve> transfer{};
  std::optional<GeometryMap> geometry{};
  std::optional<DriftLaw> drift{};
  std::optional<ResponseCurve> response{};
  std::optional<PlatePanels> picture{};
  std::vector<PixelMap> maps{};
  std::vector<std::string> reasons;
};
[[nodiscard]] MeasureLines measure_lines(const CameraMeasures& measures);

/// As judge() takes them.
[[nodiscard]] std::vector<MeasuredQuantity> quantities_of(const MeasureLines& lines);

/// Those of a session: of the camera (or of the simulated sensor alone) and of the twin.
struct SessionMeasures {
  std::optional<MeasureLines> main;
  std::optional<MeasureLines> twin;
};

/// {"main": {"quantities": [...], "noise": {...}, "transfer": {...}, "geometry": {...}, "drift": {...}, "response":
/// {...}, "pixels": {...}, "mtf": {...}, "ctf": {...}, "maps": [...], "picture": {...}, "reasons": [...]}, "twin": the
/// same or null}
[[nodiscard]] Json measures_json(const std::optional<CameraMeasures>& main, const std::optional<CameraMeasures>& twin);
/// Of numbers, maps and reasons alone.
[[nodiscard]] Json measures_json(const MeasureLines& main);
/// `invalid_input`, naming the key, for a record that is not complete or of other types.
[[nodiscard]] Result<SessionMeasures> measures_from(const Json& record);

}  // namespace todbench
