// SPDX-License-Identifier: GPL-3.0-or-later
// Image of a single shape after optics and detector of one sensor, at one accuracy.
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

/// Optics and detector of one sensor, for a scene with one motion. Shapes and positions are in detector pitches of each
/// axis (on_detectors()). Thread-safe. Filter tables are computed once per lattice.
class ImageChain {
 public:
  /// Precondition: validate(spec) succeeds.
  ImageChain(SensorSpec spec, SensorPlan plan, Accuracy accuracy, SceneMotion motion = {});

  /// Returns the lattice that keeps wrapped signal and truncated band within the tolerances of the accuracy.
  /// `size_pitch`: size of the shapes, the square root of their area.
  [[nodiscard]] FrequencyLattice lattice(double size_pitch) const;
  /// Returns the number of points per pitch at which the fine image contains the whole band. The number is a multiple
  /// of 16, so that all 16 x 16 phases lie on these points.
  [[nodiscard]] int points_per_pitch() const { return points_per_pitch_; }
  /// Returns the image of a shape of contrast 1 near the origin. With sequential readout, the row of the origin samples
  /// at the time of the picture. The times of the other rows count from this time.
  [[nodiscard]] PolygonImage image(const Polygon& shape_pitch) const;
  /// Returns whether rotating the shape by 90 degrees only rotates its image by 90 degrees.
  [[nodiscard]] bool turns_alike(const PolygonImage& image) const {
    return readout_slope_ == cv::Point2d(0, 0) && spec_.pitch_aspect() == 1 && image.turns_alike();
  }

  /// Samples of a shape on an infinite plane, with a bound on their error.
  struct InfinitePlane {
    /// Samples for a shape of contrast 1.
    cv::Mat1d values;
    /// Estimated bound on the error of a sample, in units of the contrast.
    double max_error_estimate = 0;
  };
  /// Computes samples of a shape on an infinite plane: `size` samples at distances of `step`, the first sample at
  /// `first`, both in detector pitches of each axis. Uses Richardson extrapolation from the lattice periods P and 2P,
  /// because the wrapped signal falls as P^-3. The difference between the two results gives the error bound. If a shape
  /// reaches far beyond the window, only its part near the window is computed in this way. The rest contributes the
  /// tail of the diffraction spot, which falls as distance^-3. Memory and time therefore do not grow with the shape.
  /// With sequential readout, the times of the rows count from the row of the origin.
  [[nodiscard]] InfinitePlane infinite_plane(const Polygon& shape_pitch, cv::Point2d first, double step,
                                             cv::Size size) const;

 private:
  [[nodiscard]] InfinitePlane extrapolated(const Polygon& shape_pitch, cv::Point2d first, double step,
                                           cv::Size size) const;
  /// Adds the contribution of the parts of a shape outside the square |x|, |y| <= half_width: the integrated tail of
  /// the diffraction spot. `shape` and `half_width` are in pitches along x; `first` and `step` are as for
  /// infinite_plane().
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
