// MTF from the rectangles of a plate in a mean picture.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/core/result.h"
#include "tod/measures/slanted_edge.h"
#include "tod/plate/target_plate.h"
#include "tod/registration/registration.h"

namespace todbench {

/// The MTF along one axis at one place, from one or both opposite sides of a rectangle.
struct EdgeMtf {
  std::string place;  ///< name of the rectangle
  EdgeAxis axis = EdgeAxis::x;
  int sides = 0;                            ///< that were measured
  cv::Point2d middle_px{0, 0};              ///< of the rectangle
  double angle_deg = 0;                     ///< of the edge's normal to the axis, mean of the sides
  double noise_over_step = 0;               ///< largest of the sides
  std::vector<double> frequency_per_pitch;  ///< 0 ... 1, along the normal
  std::vector<double> mtf, low, high;       ///< mean of the sides; 95 %
  std::optional<double> mtf50_per_pitch{};  ///< first frequency at which the MTF is 0.5
  /// Closed form of a simulated sensor at the same frequencies and angle; empty for any other camera.
  std::vector<double> model{};

  /// At a frequency from 0 to 1, linear between the tabulated ones, 0.01 apart.
  [[nodiscard]] double at(double frequency_per_pitch) const;
  [[nodiscard]] double low_at(double frequency_per_pitch) const;
  [[nodiscard]] double high_at(double frequency_per_pitch) const;
};

struct PlateEdges {
  std::vector<EdgeMtf> edges;          ///< the rectangle nearest to the middle of the picture first; x before y
  cv::Point2d moved_px{0, 0};          ///< the plate, from where the mapping has it
  std::vector<std::string> reasons{};  ///< sentences: sides that could not be measured
};

/// Finds the plate in the picture by its rectangles (normalised correlation, any sign of contrast), cuts a region round
/// the middle of each side that is nearly upright or level, and takes the MTF of each (slanted_edge()). Opposite sides
/// are averaged. The half-width of their mean's interval is the root of the sum of squares over their number, and never
/// less than half of what they differ by. What the optics spread beyond the window and the ends of a short side makes
/// its MTF too large by up to 3 a / (pi^2 T), with the slope a of the MTF at low frequencies and the window T: half
/// of that is taken out, and is in the interval.
///
/// `where`: mapping of the plate's millimetres to pixels but for a shift, such as the registration of another plate in
/// the same holder. `calibration` where the rectangles are not in the picture, `invalid_input` for a plate without any.
[[nodiscard]] Result<PlateEdges> plate_edges(const cv::Mat1d& picture, const TargetPlate& mounted_plate,
                                             const Registration& where);

}  // namespace todbench
