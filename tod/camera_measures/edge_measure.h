// SPDX-License-Identifier: GPL-3.0-or-later
// MTF from the rectangles of a plate in a mean picture.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/base/result.h"
#include "tod/measures/slanted_edge.h"
#include "tod/plate/target_plate.h"
#include "tod/registration/registration.h"

namespace todbench {

/// MTF along one axis at one position, from one side or two opposite sides of a rectangle.
struct EdgeMtf {
  std::string place;  ///< name of the rectangle
  EdgeAxis axis = EdgeAxis::x;
  int sides = 0;                            ///< number of measured sides
  cv::Point2d middle_px{0, 0};              ///< centre of the rectangle
  double angle_deg = 0;                     ///< angle from the axis to the normal of the edge, mean of the sides
  double noise_over_step = 0;               ///< largest value among the sides
  std::vector<double> frequency_per_pitch;  ///< 0 ... 1, along the normal
  /// Mean of the sides, and limits of the 95 % interval of the mean, which is not symmetric. low = 0: not known.
  std::vector<double> mtf, low, high;
  double widest_halo_pitch = 0;                    ///< largest sigma of the halos that are part of the MTF
  double halo_allowance = 0;                       ///< largest share of the contrast that the interval allows for halos
  double wide_halo_least = 0, wide_halo_most = 0;  ///< largest limits among the sides (SlantedEdge)
  std::optional<double> mtf50_per_pitch{};         ///< lowest frequency at which the MTF is 0.5
  /// MTF of a simulated sensor in closed form, at the same frequencies and angle; empty for a real camera.
  std::vector<double> model{};

  /// Returns the MTF at a frequency from 0 to 1, linear between the tabulated frequencies, which are 0.01 apart.
  [[nodiscard]] double at(double frequency_per_pitch) const;
  [[nodiscard]] double low_at(double frequency_per_pitch) const;
  [[nodiscard]] double high_at(double frequency_per_pitch) const;
};

/// MTF of the edges of a plate.
struct PlateEdges {
  std::vector<EdgeMtf> edges;          ///< the rectangle nearest to the picture's centre first; x before y
  cv::Point2d moved_px{0, 0};          ///< shift of the plate relative to `where`
  std::vector<std::string> reasons{};  ///< sentences about sides that could not be measured
};

/// Locates the plate in the picture by its rectangles (normalised correlation, any sign of contrast). Computes the MTF
/// of a region round the middle of each nearly vertical or nearly horizontal side (slanted_edge()), and averages
/// opposite sides. The tails of the MTF are fitted to the plate round each rectangle (plate_tails()). The contribution
/// of the tails to the interval is common to all sides of the rectangle. The lower and the upper half-width of the
/// interval are each at least half of the difference between the measured sides.
///
/// `where`: mapping from millimetres on the plate to pixels, correct except for a shift. The registration of a
/// different plate in the same holder is allowed. Errors: `calibration` (rectangles not in the picture),
/// `invalid_input` (plate without rectangles).
[[nodiscard]] Result<PlateEdges> plate_edges(const cv::Mat1d& picture, const TargetPlate& mounted_plate,
                                             const Registration& where, const TailBounds& bounds);
[[nodiscard]] inline Result<PlateEdges> plate_edges(const cv::Mat1d& picture, const TargetPlate& mounted_plate,
                                                    const Registration& where) {
  return plate_edges(picture, mounted_plate, where, TailBounds{});
}

}  // namespace todbench
