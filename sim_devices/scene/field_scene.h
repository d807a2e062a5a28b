// SPDX-License-Identifier: GPL-3.0-or-later
// Scene in the field: polygons in metres with temperature and emissivity, or a radiometric picture.
#pragma once

#include <cstddef>
#include <opencv2/core.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "acquisition/base/result.h"
#include "hvs/shape/painted_shapes.h"
#include "sim_devices/atmosphere/band_radiance.h"
#include "tod/plate/target_plate.h"

namespace todbench {

/// Grey surface. It reflects the surround of the scene with 1 - emissivity.
struct SceneRegion {
  std::string name;
  Polygon outline_m;  ///< x right, y down, in the plane perpendicular to the line of sight
  double temperature_k = 300, emissivity = 1;
  bool target = false;  ///< part of the target to be identified
};

/// Calibrated picture, taken by a finer camera at a shorter range. Its middle is the origin of the scene.
struct ScenePicture {
  cv::Mat1d kelvin;      ///< radiation temperatures
  cv::Mat1b target;      ///< not 0: part of the target; empty: no target
  double element_m = 0;  ///< side of a picture element at the scene
};

/// Scene of regions in the order of painting (later regions cover earlier regions), or of a picture. Copyable.
struct FieldScene {
  std::string name, description;
  double background_k = 300;  ///< temperature of places without a region, or beyond the edges of the picture
  double background_emissivity = 1;
  double surround_k = 300;  ///< radiation temperature of the reflected surround
  std::vector<SceneRegion> regions;
  std::optional<ScenePicture> picture{};
};

/// Largest number of views of a target.
inline constexpr std::size_t most_aspects = 16;
/// Target of a set with its views. The origin of each view is the middle of the visible target.
struct IdentificationTarget {
  std::string name;
  std::vector<FieldScene> aspects;
};

/// Checks a scene. Errors: `invalid_input` in one sentence (an empty scene, temperatures of 0 K or below, emissivities
/// outside 0 to 1, outlines that cross themselves or have no area, a picture without scale or with values that are not
/// temperatures).
[[nodiscard]] Result<void> validate(const FieldScene& scene);

/// Returns a scene of the cut-outs of a plate in front of their surround, all marked as targets. A millimetre of the
/// plate is 0.001 m in the scene. `delta_t_k`: cut-outs minus surround; `background_k`: temperature of the surround.
[[nodiscard]] FieldScene scene_of_plate(const TargetPlate& plate, double delta_t_k, double background_k);

/// Radiometry of a camera: its band, and the temperature at which radiance is converted to kelvin.
struct RadianceScale {
  SpectralBand band{};
  double calibration_k = 300;
  /// Returns a radiance difference in W/(m2 sr), divided by dB/dT at calibration_k.
  [[nodiscard]] double kelvin(double radiance_w_m2_sr) const;
};

/// Returns the regions in equivalent kelvin against the background, without air: [L - L_background] / (dB/dT).
[[nodiscard]] std::vector<PaintedPolygon> levels_k(const FieldScene& scene, const RadianceScale& scale);
/// Returns the picture in the same unit. Precondition: the scene has a picture.
[[nodiscard]] cv::Mat1d picture_levels_k(const FieldScene& scene, const RadianceScale& scale);
/// Returns the radiance of the background at the scene, in W/(m2 sr).
[[nodiscard]] double background_radiance(const FieldScene& scene, const SpectralBand& band);

/// Signature of a target for range models: effective size and contrast.
struct TargetSignature {
  double area_m2 = 0;    ///< visible area
  double mean_dt_k = 0;  ///< mean over the target minus mean along its outline, equivalent kelvin
  double sd_k = 0;       ///< standard deviation over the target, equivalent kelvin
  /// Returns sqrt(mean^2 + sd^2) in equivalent kelvin.
  [[nodiscard]] double dt_rss_k() const;
  /// Returns the square root of the area.
  [[nodiscard]] double size_m() const;
};
/// Returns the signature of all parts that are marked as target. The mean along the outline is weighted by length.
/// Empty if no target is visible. Exact for polygons.
[[nodiscard]] std::optional<TargetSignature> target_signature(const FieldScene& scene, const RadianceScale& scale);

/// Returns the largest extent of regions or picture in metres, along x and y.
[[nodiscard]] cv::Size2d extent_m(const FieldScene& scene);

}  // namespace todbench
