// SPDX-License-Identifier: GPL-3.0-or-later
// Whole frames of scenes with any number of polygons: the calculation of ImageChain, arranged for many edges.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <opencv2/core.hpp>
#include <span>
#include <utility>

#include "acquisition/base/accuracy.h"
#include "hvs/shape/painted_shapes.h"
#include "sim_devices/sensor/sensor_plan.h"
#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

/// Samples of a scene after optics and detector of one sensor. Thread-safe. Tables are computed once per sensor and
/// frame size.
///
/// The method splits a scene into its exact means over the cells of the sampling grid and a remainder in the cells that
/// an edge crosses. The means are filtered with the response to a unit cell, including all frequencies that sampling
/// folds. The remainder has mean 0 and is expanded in Legendre polynomials over the cell, with exact coefficients
/// (theorem of Gauss and Green). Each polynomial has its own response, which falls as distance^-4 and is kept for 6
/// samples. The degree follows from the band: the result agrees with ImageChain to 3e-5 of a contrast (test
/// SceneImager.EqualsTheImageOfThePolygonAlone).
///
/// For an interlaced sensor, each field shows a moving scene at the time of the field (effect_readout.h).
///
/// The plane has level 0 outside the frame and its margin. The margin is 48 pitches, plus the reach of a halo. Frame
/// and margin are repeated periodically, so a contrast that reaches the edge of the frame has an error of up to 3e-4 of
/// its value there.
class SceneImager {
 public:
  /// Precondition: validate(spec) succeeds. The plan selects the effects of image formation; noise is not applied.
  SceneImager(SensorSpec spec, SensorPlan plan, Accuracy accuracy, SceneMotion motion = {});
  ~SceneImager();

  /// Returns the image of the edges. Edges are in samples, x right, y down; sample (i, j) is centred at (i, j).
  [[nodiscard]] cv::Mat1d image(std::span<const StepEdge> edges, cv::Size size) const;

  /// Returns the scene without image formation: its mean over every cell of the grid. Parts outside the frame are
  /// ignored.
  [[nodiscard]] static cv::Mat1d means(std::span<const StepEdge> edges, cv::Size size);

  /// Returns the image of a picture instead of edges. Each element of the picture is a square with a side of
  /// `pixel_samples` (at most 1); element (0, 0) is centred at `first`. Beyond the picture the level is 0.
  [[nodiscard]] cv::Mat1d image(const cv::Mat1d& picture, double pixel_samples, cv::Point2d first, cv::Size size) const;

 private:
  struct Tables;
  std::unique_ptr<const Tables> tables_;
  mutable std::mutex mutex_;
  mutable std::map<std::pair<int, int>, std::shared_ptr<const cv::Mat>> cell_responses_;  ///< by padded size
  [[nodiscard]] std::shared_ptr<const cv::Mat> cell_response(cv::Size whole) const;
  [[nodiscard]] cv::Size padded(cv::Size size) const;
  struct Cells;
  [[nodiscard]] cv::Mat1d imaged(const Cells& cells, cv::Size size) const;
  [[nodiscard]] cv::Mat1d at_one_time(const cv::Mat1d& picture, double pixel_samples, cv::Point2d first,
                                      cv::Size size) const;
};

}  // namespace todbench
