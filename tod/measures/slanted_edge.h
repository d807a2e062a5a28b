// MTF from the picture of a slanted edge (e-SFR, in the spirit of ISO 12233).
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/core/result.h"

namespace todbench {

/// Along which axis the frequency runs.
enum class EdgeAxis {
  x,  ///< along rows, from a nearly vertical edge: the horizontal MTF
  y,  ///< along columns, from a nearly horizontal edge
};
[[nodiscard]] std::string_view to_string(EdgeAxis axis);

struct SlantedEdgeOptions {
  std::optional<EdgeAxis> axis{};  ///< nothing: across the edge that is there
};

/// The MTF along the normal of an edge.
struct SlantedEdge {
  EdgeAxis axis = EdgeAxis::x;
  /// Of the edge's normal to the axis: the edge stands at x0 - (row - middle) tan(angle), and alike along y.
  double angle_deg = 0;
  double edge_at_pitch = 0;    ///< where it crosses the middle row (column), in pixels from the first pixel's centre
  double curvature_pitch = 0;  ///< by how much its middle lies off the straight line through its ends
  double step = 0;             ///< signal of the bright side over the dark one
  double noise_over_step = 0;  ///< standard deviation of a pixel about the edge profile
  double shading_percent = 0;  ///< change of the two sides over the window in % of the step; taken out where it is sure
  double window_pitch = 0;     ///< how much of the profile counts fully
  int rows = 0;                ///< lines across the edge that were used
  std::vector<double> frequency_per_pitch;  ///< 0 ... 1 cycle per pitch, along the normal
  std::vector<double> mtf;                  ///< 1 at frequency 0
  std::vector<double> mtf_low, mtf_high;    ///< 95 %
  std::optional<double> mtf50_per_pitch;    ///< first frequency at which the MTF is 0.5
  std::vector<std::string> notes;           ///< sentences
};

/// Projects every pixel along the edge, fits the profile by a cubic spline with four knots a pitch and transforms its
/// derivative, which is known in closed form: neither bins nor differences, hence no correction of either. The
/// frequency axis is that along the normal (the cosine of the angle is in it). Intervals are a jackknife over groups of
/// neighbouring lines with Student's t, and the method's own error (0.0003 up to half a cycle per pitch, see
/// docs/physical-measures.md).
///
/// The picture shows one straight edge with a flat field on both sides, in any linear unit. `invalid_input` in one
/// sentence where it does not: no edge that stands out of the noise, a slant of less than a pitch over the picture or
/// beyond 25 degrees or one that leaves gaps between the samples, an edge that leaves the picture or comes closer than
/// 5 pitches to its border, is bent, or was clipped.
[[nodiscard]] Result<SlantedEdge> slanted_edge(const cv::Mat1d& picture, const SlantedEdgeOptions& options);

}  // namespace todbench
