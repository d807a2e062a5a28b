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

/// A grey surface. It reflects the scene's surround with 1 - emissivity.
struct SceneRegion {
  std::string name;
  Polygon outline_m;  ///< x right, y down, in the plane perpendicular to the line of sight
  double temperature_k = 300, emissivity = 1;
  bool target = false;  ///< part of the target to be identified
};

/// A calibrated picture, taken by a finer camera at a shorter range. Its middle is the scene's origin.
struct ScenePicture {
  cv::Mat1d kelvin;      ///< radiation temperatures
  cv::Mat1b target;      ///< not 0: part of the target; empty: no target
  double element_m = 0;  ///< side of a picture element at the scene
};

/// Regions in the order of painting (later ones cover earlier ones), or a picture. A value.
struct FieldScene {
  std::string name, description;
  double background_k = 300;  ///< of places without region; with a picture: beyond its edges
  double background_emissivity = 1;
  double surround_k = 300;  ///< radiation temperature of the reflected surround
  std::vector<SceneRegion> regions;
  std::optional<ScenePicture> picture{};
};

/// Largest number of views of a target.
inline constexpr std::size_t most_aspects = 16;
/// One target of a set with its views; the middle of the visible target is the origin.
struct IdentificationTarget {
  std::string name;
  std::vector<FieldScene> aspects;
};

/// `invalid_input` in one sentence: an empty scene, temperatures of 0 K or below, emissivities outside 0 to 1, outlines
/// that cross themselves or have no area, a picture without scale or with values that are not temperatures.
[[nodiscard]] Result<void> validate(const FieldScene& scene);

/// Scene of the triangles of a plate in front of their surround, millimetres as metres / 1000. All are targets.
[[nodiscard]] FieldScene scene_of_plate(const TargetPlate& plate, double delta_t_k, double background_k);

/// Radiometry of a camera: its band, and the temperature at which radiance is converted to kelvin.
struct RadianceScale {
  SpectralBand band{};
  double calibration_k = 300;
  /// Radiance difference, W/(m2 sr), divided by dB/dT at calibration_k.
  [[nodiscard]] double kelvin(double radiance_w_m2_sr) const;
};

/// Regions in equivalent kelvin against the background, without air: [L - L_background] / (dB/dT).
[[nodiscard]] std::vector<PaintedPolygon> levels_k(const FieldScene& scene, const RadianceScale& scale);
/// The picture in the same unit. Precondition: the scene has a picture.
[[nodiscard]] cv::Mat1d picture_levels_k(const FieldScene& scene, const RadianceScale& scale);
/// Radiance of the background at the scene, W/(m2 sr).
[[nodiscard]] double background_radiance(const FieldScene& scene, const SpectralBand& band);

/// Signature of a target for range models: effective size and contrast.
struct TargetSignature {
  double area_m2 = 0;    ///< visible area
  double mean_dt_k = 0;  ///< mean over the target minus mean along its outline, equivalent kelvin
  double sd_k = 0;       ///< over the target
  /// sqrt(mean^2 + sd^2).
  [[nodiscard]] double dt_rss_k() const;
  /// Square root of the area.
  [[nodiscard]] double size_m() const;
};
/// Signature of everything marked as target. The mean along the outline is weighted by length. Empty if no target is
/// visible. Exact for polygons.
[[nodiscard]] std::optional<TargetSignature> target_signature(const FieldScene& scene, const RadianceScale& scale);

/// Largest extent of regions or picture in metres, along x and y.
[[nodiscard]] cv::Size2d extent_m(const FieldScene& scene);

}  // namespace todbench
