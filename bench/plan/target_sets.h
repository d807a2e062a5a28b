// SPDX-License-Identifier: GPL-3.0-or-later
// Sets of targets to be discriminated, from their TOML files: models seen from several sides, or radiometric pictures.
#pragma once

#include <functional>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/base/result.h"
#include "bench/plan/scene_descriptions.h"
#include "sim_devices/scene/field_scene.h"

namespace todbench {

/// Reads the mean of the first `frames` pictures of a recording in kelvin. `file` is the path of the recording,
/// followed by "?QUERY" if the recording needs a query. Errors: those of the recording; `calibration` if it has no
/// temperatures.
using TemperatureReader = std::function<Result<cv::Mat1d>(const std::string& file, int frames)>;
/// Readers of the files that a set names. The readers are not part of this library.
struct SetReaders {
  TemperatureReader temperatures;
  PictureReader mask;
};

/// Targets in front of a uniform background; all have the same number of views.
struct TargetSet {
  std::string name, description;
  std::vector<IdentificationTarget> targets;  ///< targets of the set, at least two
  std::vector<double> azimuths_deg;           ///< sides from which models are seen; empty: the views are pictures
  std::vector<std::string> notes;             ///< messages about pictures whose background is not uniform
};
/// Loads a target set by name ("small-craft") or file. Files that the set names are relative to its folder. Without
/// readers a set of pictures is refused. Errors: `invalid_input` (as load_scene(); a picture without a target, a
/// target that touches the edge of its region, pixels without temperature, a mask of a wrong size), those of readers.
[[nodiscard]] Result<TargetSet> load_target_set(std::string_view reference, const SetReaders& readers = {});

/// Region of a picture and its target, as a set describes them.
struct PictureCut {
  cv::Rect region{};  ///< region in pixels; empty: the whole picture
  std::optional<double> above_k{}, below_k{};
  cv::Mat1b mask{};  ///< mask of the whole picture, in place of thresholds
  std::optional<double> background_k{};
};
/// A target of a picture in front of its background.
struct CutTarget {
  ScenePicture picture;  ///< picture without a scale; elements outside the target have the temperature of the
                         ///< background
  cv::Size target_px;    ///< extent of the target
  double background_k = 0;
  /// Standard deviation of the background pixels, in K; empty if there are too few pixels.
  std::optional<double> background_sd_k{};
};
/// Cuts the target. The background is `background_k` of the cut. If `background_k` is empty, the background is the mean
/// of the pixels at a distance of 3 to 5 pixels from the target. Nearer pixels contain the blur of the camera that took
/// the picture. Errors: `invalid_input`.
[[nodiscard]] Result<CutTarget> cut_target(const cv::Mat1d& kelvin, const PictureCut& cut);

/// Returns the smallest and largest side of an element of the pictures of a set, in m; empty for models.
[[nodiscard]] std::optional<std::pair<double, double>> element_range_m(const TargetSet& set);

}  // namespace todbench
