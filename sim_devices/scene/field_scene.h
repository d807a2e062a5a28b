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

/// Grey surface. Its reflectance is 1 - emissivity.
struct SceneRegion {
  std::string name;            ///< name in messages, "hull"
  Polygon outline_m;           ///< corners in the plane perpendicular to the line of sight, x right, y down
  double temperature_k = 300,  ///< surface temperature
      emissivity = 1;          ///< emissivity of the surface, 0 to 1
  bool target = false;         ///< true if the region belongs to the target to be identified
};

/// Calibrated picture, taken by a finer camera at a shorter range. The centre of the picture is the origin of the
/// scene.
struct ScenePicture {
  cv::Mat1d kelvin;      ///< radiation temperature of each picture element
  cv::Mat1b target;      ///< mask of the target: not 0 inside; an empty matrix means that there is no target
  double element_m = 0;  ///< side length of a picture element in the scene
};

/// Scene that consists of regions or of a picture. Copyable.
struct FieldScene {
  std::string name,                       ///< short name, "tank-front"
      description;                        ///< description for people
  double background_k = 300;              ///< temperature outside all regions, or outside the picture
  double background_emissivity = 1;       ///< emissivity of the background, 0 to 1
  double surround_k = 300;                ///< radiation temperature of the surround that the surfaces reflect
  std::vector<SceneRegion> regions;       ///< regions in the order of painting: later regions cover earlier regions
  std::optional<ScenePicture> picture{};  ///< picture that replaces the regions; empty: the scene consists of regions
};

/// Maximum number of views of a target.
inline constexpr std::size_t most_aspects = 16;
/// Target of a set for identification.
struct IdentificationTarget {
  std::string name;                 ///< name of the target in the set
  std::vector<FieldScene> aspects;  ///< views of the target; the origin of each view is the centre of the visible
                                    ///< target
};

/// Checks a scene. Error: `invalid_input` (an empty scene, temperatures of 0 K or below, emissivities outside 0 to 1,
/// outlines that cross themselves or have no area, a picture without scale or with values that are not temperatures).
[[nodiscard]] Result<void> validate(const FieldScene& scene);

/// Returns a scene in which the cut-outs of a plate are the regions. All regions are marked as targets. One millimetre
/// on the plate is 0.001 m in the scene. `delta_t_k`: temperature of the cut-outs minus temperature of the plate.
/// `background_k`: temperature of the plate.
[[nodiscard]] FieldScene scene_of_plate(const TargetPlate& plate, double delta_t_k, double background_k);

/// Radiometry of a camera: its band, and the temperature at which radiance is converted to kelvin.
struct RadianceScale {
  SpectralBand band{};         ///< wavelengths to which the camera is sensitive
  double calibration_k = 300;  ///< temperature at which radiance differences are converted to kelvin
  /// Converts a radiance difference in W/(m2 sr) to kelvin: divides the difference by dB/dT at calibration_k.
  [[nodiscard]] double kelvin(double radiance_w_m2_sr) const;
};

/// Returns the regions in equivalent kelvin, without air: [radiance - background radiance] / (dB/dT).
[[nodiscard]] std::vector<PaintedPolygon> levels_k(const FieldScene& scene, const RadianceScale& scale);
/// Returns the picture in equivalent kelvin against the background, without air. Precondition: the scene has a picture.
[[nodiscard]] cv::Mat1d picture_levels_k(const FieldScene& scene, const RadianceScale& scale);
/// Returns the radiance of the background at the scene, in W/(m2 sr).
[[nodiscard]] double background_radiance(const FieldScene& scene, const SpectralBand& band);

/// Signature of a target for range models: effective size and contrast.
struct TargetSignature {
  double area_m2 = 0;    ///< visible area of the target
  double mean_dt_k = 0;  ///< mean over the target minus mean along its outline, in equivalent kelvin
  double sd_k = 0;       ///< standard deviation over the target, in equivalent kelvin
  /// Returns the effective contrast sqrt(mean_dt_k^2 + sd_k^2) in equivalent kelvin.
  [[nodiscard]] double dt_rss_k() const;
  /// Returns the effective size, the square root of the area, in metres.
  [[nodiscard]] double size_m() const;
};
/// Returns the signature of all parts that are marked as target; empty if no target is visible. The mean along the
/// outline is weighted by length. Area, mean and standard deviation over the target are exact for polygons.
[[nodiscard]] std::optional<TargetSignature> target_signature(const FieldScene& scene, const RadianceScale& scale);

/// Returns the extent of all regions, or of the picture, along x and y in metres.
[[nodiscard]] cv::Size2d extent_m(const FieldScene& scene);

}  // namespace todbench
