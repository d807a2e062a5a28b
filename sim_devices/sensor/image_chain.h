// SPDX-License-Identifier: GPL-3.0-or-later
// Degraded pictures of single shapes: image formation of one sensor at one accuracy.
#pragma once

#include <map>
#include <memory>
#include <mutex>

#include "acquisition/base/accuracy.h"
#include "hvs/shape/polygon_image.h"
#include "sim_devices/sensor/effect_row.h"
#include "sim_devices/sensor/sensor_plan.h"
#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

/// Optics and detector of one sensor, for a scene of one motion. Shapes and places are in detector pitches of each axis
/// (on_detectors()). Thread-safe. Filter tables are computed once per lattice.
class ImageChain {
 public:
  /// Precondition: validate(spec) succeeds.
  ImageChain(SensorSpec spec, SensorPlan plan, Accuracy accuracy, SceneMotion motion = {});

  /// Lattice that keeps wrapped signal and truncated band within the tolerances, for shapes of `size_pitch` (square
  /// root of area).
  [[nodiscard]] FrequencyLattice lattice(double size_pitch) const;
  /// Points per pitch at which the fine image contains the whole band: a multiple of 16, so that all 16 x 16 phases lie
  /// on it.
  [[nodiscard]] int points_per_pitch() const { return points_per_pitch_; }
  /// Degraded image of a shape of contrast 1 near the origin. The origin lies in the row that samples at the time of
  /// the picture.
  [[nodiscard]] PolygonImage image(const Polygon& shape_pitch) const;
  /// True if the image of the shape turned by a quarter is `image` turned by a quarter.
  [[nodiscard]] bool turns_alike(const PolygonImage& image) const {
    return readout_slope_ == cv::Point2d(0, 0) && spec_.pitch_aspect() == 1 && image.turns_alike();
  }

  /// Samples for an infinite plane, by Richardson extrapolation from periods P and 2P (the wrapped signal falls as
  /// P^-3). The bound on the remaining error is estimated from their difference. If a shape reaches far beyond the
  /// window, only the part near the window is computed in this way. The rest adds the integrated tail of the
  /// diffraction spot, c r^-3, so memory and time do not grow with the shape. Sequential readout refers to the origin.
  struct InfinitePlane {
    cv::Mat1d values;
    double max_error_estimate = 0;
  };
  [[nodiscard]] InfinitePlane infinite_plane(const Polygon& shape_pitch, cv::Point2d first, double step,
                                             cv::Size size) const;

 private:
  [[nodiscard]] InfinitePlane extrapolated(const Polygon& shape_pitch, cv::Point2d first, double step,
                                           cv::Size size) const;
  /// `shape` and `half_width` are in pitches along x; `first` and `step` as above.
  void add_far_field(InfinitePlane& near, const Polygon& shape, cv::Point2d first, double step,
                     double half_width) const;
  [[nodiscard]] std::shared_ptr<const FilterTable> filter(const FrequencyLattice& lattice) const;
  [[nodiscard]] ChainScope scope() const;
  [[nodiscard]] TransferFunction transfer_on(const FrequencyLattice& lattice) const;
  [[nodiscard]] Polygon read_out(const Polygon& shape_pitch) const;

  SensorSpec spec_;
  SensorPlan plan_;
  Accuracy accuracy_;
  SceneMotion motion_;
  Spread spread_;
  cv::Point2d readout_slope_;
  double band_per_pitch_ = 0;
  int points_per_pitch_ = 16;
  mutable std::mutex mutex_;
  mutable std::map<int, std::shared_ptr<const FilterTable>> filters_;  ///< by period
};

/// Converts a shape from pitches along x to pitches of each axis: divides y by pitch_aspect().
[[nodiscard]] Polygon on_detectors(Polygon shape_pitch, const SensorSpec& spec);

}  // namespace todbench
