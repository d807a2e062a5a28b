// SPDX-License-Identifier: GPL-3.0-or-later
// MTF from the picture of a slanted edge (e-SFR, similar to ISO 12233).
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/base/result.h"
#include "tod/measures/edge_tails.h"

namespace todbench {

/// Axis of the frequency.
enum class EdgeAxis {
  x,  ///< along rows, from a nearly vertical edge: the horizontal MTF
  y,  ///< along columns, from a nearly horizontal edge
};
[[nodiscard]] std::string_view to_string(EdgeAxis axis);

/// Tails that were fitted to the picture of a whole plate.
struct PlateTails {
  TailFit fit;
  TailColumns columns;  ///< columns at positions in the part of the picture with the edge
  double step = 1;      ///< signed step of the picture for a unit step of the model
};

/// Share of the step in wide halos above which wide halos are significant: four times the error of the method.
inline constexpr double least_wide_share = 0.002;

/// Options of slanted_edge().
struct SlantedEdgeOptions {
  std::optional<EdgeAxis> axis{};  ///< empty: determined from the direction of the edge in the picture
  TailBounds tails{};              ///< bounds for tails that are fitted to this picture
  /// Tails from a larger picture that contains this picture. Null: the tails are fitted to this picture, outside the
  /// core.
  const PlateTails* plate = nullptr;
};

/// The MTF along the normal of an edge.
struct SlantedEdge {
  EdgeAxis axis = EdgeAxis::x;
  /// Angle from the axis to the edge's normal: the edge is at edge_at_pitch - (row - middle) tan(angle) (y: column).
  double angle_deg = 0;
  /// Position of the edge on the middle row (column), in pixels from the centre of the first pixel.
  double edge_at_pitch = 0;
  /// Distance of the middle of the edge from the straight line through its two end points.
  double curvature_pitch = 0;
  double step = 0;             ///< signal of the bright side minus signal of the dark side
  double noise_over_step = 0;  ///< standard deviation of a pixel about the edge profile
  /// Change of the level of both sides over the window, in % of the step; removed if significant.
  double shading_percent = 0;
  double window_pitch = 0;                  ///< width of the range of the profile with full weight
  int rows = 0;                             ///< number of lines across the edge that were used
  std::vector<double> frequency_per_pitch;  ///< 0 ... 1 cycle per pitch, along the normal
  std::vector<double> mtf;                  ///< 1 at frequency 0
  /// Limits of the 95 % interval relative to a source of any size. The interval is not symmetric, so use both limits.
  std::vector<double> mtf_low, mtf_high;
  /// Lower limits relative to a source of the size of the picture: as `mtf_low`, but without halos wider than
  /// `widest_halo_pitch`.
  std::vector<double> mtf_low_in_picture;
  std::vector<bool> low_known;   ///< false: only TailBounds::most_halo determines `mtf_low`
  double widest_halo_pitch = 0;  ///< largest sigma of the halos that are part of the MTF
  double halo_allowance = 0;     ///< largest share of the contrast that the interval allows for halos
  /// Limits (95 %) for the share of the step in halos wider than `widest_halo_pitch`. If the upper limit is above
  /// least_wide_share, `mtf_low` is lower than `mtf_low_in_picture` by the share `wide_halo_most`.
  double wide_halo_least = 0, wide_halo_most = 0;
  /// True: the picture is sharpened, and halos with negative shares are part of the fit and of the intervals.
  bool sharpened = false;
  double displacement_pitch = 0;  ///< standard deviation of the lines' positions about the edge; 0 if not significant
  std::optional<double> mtf50_per_pitch;  ///< lowest frequency at which the MTF is 0.5
  std::vector<std::string> notes;         ///< sentences
};

/// Projects every pixel along the edge, fits a cubic spline with four knots per pitch to the profile, and transforms
/// the derivative of the spline in closed form. No corrections for bins or finite differences are needed, because the
/// method does not use them. The frequency axis is along the normal (the cosine of the angle is included). Intervals
/// combine three contributions: a jackknife over groups of neighbouring lines with Student's t, the extremes of the
/// tails, and the error of the method (0.0005 up to half a cycle per pitch, see docs/method/physical-measures.md). The
/// MTF is relative to a source of the size of the picture (edge_tails.h).
///
/// Precondition: one straight edge with a flat field on both sides, in any linear unit. Errors: `invalid_input` (an
/// edge that does not exceed the noise, is partly outside the picture or closer than 5 pitches to its border, is bent,
/// or is clipped; a slant of less than a pitch over the picture or of more than 46 degrees; a slant that leaves gaps
/// between the samples).
[[nodiscard]] Result<SlantedEdge> slanted_edge(const cv::Mat1d& picture, const SlantedEdgeOptions& options);

}  // namespace todbench
