// Whole frames of scenes of any number of polygons: the chain of triangles, arranged for many edges.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <opencv2/core.hpp>
#include <span>
#include <utility>

#include "acquisition/core/accuracy.h"
#include "hvs/shape/painted_shapes.h"
#include "sim_devices/sensor/sensor_plan.h"
#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

/// Samples of a scene behind optics and detector of one sensor. Thread-safe; tables are computed once per sensor and
/// frame size.
///
/// A scene is split into its means over the cells of the sampling grid, exact, and what is left in the cells that an
/// edge passes. The means are filtered with the response to a unit cell, all frequencies that sampling folds included.
/// What is left has mean 0 and is expanded in Legendre polynomials over the cell, their coefficients exact by Gauss and
/// Green; each has its own response, which falls as r^-4 and is kept for 6 samples. The degree is what the band
/// asks for: to 3e-5 of a contrast equal to ImageChain (test SceneImager.EqualsTheImageOfThePolygonAlone).
///
/// The plane outside the frame and a margin of 48 pitches is taken as level 0. The frame is periodic with that margin:
/// a contrast that reaches the frame's edge is off by up to 3e-4 of itself there.
class SceneImager {
 public:
  /// Precondition: validate(spec) succeeds. The plan says which effects of image formation act; noise has no part here.
  SceneImager(SensorSpec spec, SensorPlan plan, Accuracy accuracy, SceneMotion motion = {});
  ~SceneImager();

  /// Edges in samples, x right, y down; sample (i, j) is centred at (i, j).
  [[nodiscard]] cv::Mat1d image(std::span<const StepEdge> edges, cv::Size size) const;

  /// The scene itself: its mean over every cell of the grid. What is left of the frame, right of it, above and below
  /// does not count.
  [[nodiscard]] static cv::Mat1d means(std::span<const StepEdge> edges, cv::Size size);

  /// A picture instead of edges: every element a square of `pixel_samples` on a side (at most 1), element (0, 0)
  /// centred at `first`. Beyond the picture: level 0.
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
};

}  // namespace todbench
