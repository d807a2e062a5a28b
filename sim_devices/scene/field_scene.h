// What a camera sees in the field: polygons in metres with temperature and emissivity, or a radiometric picture.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "acquisition/core/result.h"
#include "hvs/shape/painted_shapes.h"
#include "sim_devices/atmosphere/band_radiance.h"
#include "tod/plate/target_plate.h"

namespace todbench {

/// A grey surface. What it does not emit it reflects of the scene's surround.
struct SceneRegion {
  std::string name;
  Polygon outline_m;  ///< x right, y down, in the plane across the line of sight
  double temperature_k = 300, emissivity = 1;
  bool target = false;  ///< part of what is to be identified
};

/// A calibrated picture of a finer camera from nearer by. Its middle is the scene's origin.
struct ScenePicture {
  cv::Mat1d kelvin;       ///< radiation temperatures
  cv::Mat1b target;       ///< not 0: part of the target; empty: nothing is
  double pixel_mrad = 0;  ///< of an element
  double range_m = 0;     ///< from which it was taken
};

/// Regions in the order of painting, later ones cover earlier ones; or a picture. A value.
struct FieldScene {
  std::string name, description;
  double background_k = 300;  ///< of what no region covers; with a picture: what is beyond it
  double background_emissivity = 1;
  double surround_k = 300;  ///< radiation temperature of what is reflected
  std::vector<SceneRegion> regions;
  std::optional<ScenePicture> picture{};
};

/// `invalid_input` in one sentence: nothing to see, temperatures of 0 K or below, emissivities outside 0 to 1, outlines
/// that cross themselves or enclose nothing, a picture without scale or with values that are no temperature.
[[nodiscard]] Result<void> validate(const FieldScene& scene);

/// The triangles of a plate before their surround, millimetres as metres / 1000; all of them targets.
[[nodiscard]] FieldScene scene_of_plate(const TargetPlate& plate, double delta_t_k, double background_k);

/// The radiometry of a camera: its band, and the temperature at which radiance becomes kelvin.
struct RadianceScale {
  SpectralBand band{};
  double calibration_k = 300;
  /// A radiance difference, W/(m2 sr), over dB/dT at calibration_k.
  [[nodiscard]] double kelvin(double radiance_w_m2_sr) const;
};

/// Regions in equivalent kelvin against the background, before any air: [L - L_background] / (dB/dT).
[[nodiscard]] std::vector<PaintedPolygon> levels_k(const FieldScene& scene, const RadianceScale& scale);
/// The picture in the same unit. Precondition: there is one.
[[nodiscard]] cv::Mat1d picture_levels_k(const FieldScene& scene, const RadianceScale& scale);
/// Radiance of the background at the scene, W/(m2 sr).
[[nodiscard]] double background_radiance(const FieldScene& scene, const SpectralBand& band);

/// What a range model wants of a target: effective size and contrast.
struct TargetSignature {
  double area_m2 = 0;    ///< that is seen
  double mean_dt_k = 0;  ///< mean over the target minus mean beside its outline, equivalent kelvin
  double sd_k = 0;       ///< over the target
  /// sqrt(mean^2 + sd^2).
  [[nodiscard]] double dt_rss_k() const;
  /// Square root of the area.
  [[nodiscard]] double size_m() const;
};
/// Of everything marked as target; the mean beside the outline is weighted by its length. Nothing where no target is
/// seen. Of polygons exact.
[[nodiscard]] std::optional<TargetSignature> target_signature(const FieldScene& scene, const RadianceScale& scale);

/// Largest extent of regions or picture from side to side in metres, x and y.
[[nodiscard]] cv::Size2d extent_m(const FieldScene& scene);

}  // namespace todbench
