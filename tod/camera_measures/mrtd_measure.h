// SPDX-License-Identifier: GPL-3.0-or-later
// Measures the MRTD of a camera with a plate of bars. The template observer discriminates four bars from five, at
// contrasts of both polarities.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "acquisition/base/interval.h"
#include "hvs/observer/template_observer.h"
#include "tod/camera_measures/kept_bars.h"
#include "tod/measurement/frame_taker.h"
#include "tod/measures/slanted_edge.h"
#include "tod/plate/target_plate.h"
#include "tod/presentation/target.h"
#include "tod/registration/registration.h"

namespace todbench {

/// Options of measure_mrtd().
struct MrtdOptions {
  TargetPlate plate{};  ///< plate in identity mounting, with bar_pairs()
  /// Magnitudes of the contrasts, shown at both polarities.
  std::vector<double> contrasts_k{0.0025, 0.005, 0.01, 0.02, 0.04, 0.08, 0.16, 0.32};
  int frames = 16;  ///< number of frames judged at each contrast of each set-up, one by one
  /// Number of positions of the plate relative to the pixels, divided among the mountings; at least 5.
  int set_ups = 8;
  std::vector<Mounting> mountings{Mounting::identity};
  double frequency_per_pitch = 0.25;  ///< requested; the result is that of the bars nearest in frequency
  double spot_px = 3;                 ///< requested; the result is that of the spot nearest in size
  double pitch_mrad = 0;              ///< IFOV of a pixel
  double locating_k = 4;              ///< contrast at which the plate is located
  int registration_frames = 32;       ///< number of frames averaged to locate the plate
  int kept_frames = 0;                ///< number of frames kept for human observers at each contrast of each set-up
  double response = 1;                ///< observed contrast divided by the contrast that the target reports
  TemplateObserverSpec observer{};    ///< an observer with an eye includes its display
  std::uint64_t seed = 1;             ///< seed of the observer's noise
};

/// Threshold of one pair of groups of bars (MRTD), or of one spot against an empty part of the plate (MDTD).
struct MrtdPoint {
  std::string place;  ///< name of the group with four bars, or of the spot
  EdgeAxis axis = EdgeAxis::x;
  double frequency_per_pitch = 0;  ///< frequency of the four bars in the picture; 0: a spot
  double size_px = 0;              ///< side of the spot; 0: bars
  /// Contrasts for 75 % correct answers at each polarity; the contrast of negative polarity is below 0.
  std::optional<double> positive_k{}, negative_k{};
  std::optional<double> threshold_k{};  ///< half of (positive_k - negative_k)
  Interval ci95{};                      ///< interval of threshold_k, by jackknife over the set-ups
  /// Values of threshold_k for the best and the worst observer within the range of open parameters (open_parameters.h),
  /// from the same frames. Empty without an eye, or if one of the two observers has no threshold. This is not a
  /// confidence interval.
  std::optional<std::pair<double, double>> spread_k{};
  std::string reason{};                  ///< reason for a missing threshold; empty if there is one
  std::optional<double> best_phase_k{};  ///< threshold at the best sampling phase; empty: not found
  Interval best_phase_ci95{};
  /// Distance between the middle of the bars and the nearest pixel border at the best sampling phase, 0 to 0.5 pixels.
  double best_phase = 0;
  /// Shares of correct decisions by contrast, over all set-ups.
  std::vector<double> positive_share{}, negative_share{};
};

/// Result of measure_mrtd().
struct MrtdMeasure {
  std::string plate, observer;
  int frames = 0, set_ups = 0, mountings = 0;
  double pitch_mrad = 0;
  double frequency_per_pitch = 0, spot_px = 0;  ///< requested
  std::vector<double> contrast_k{};  ///< mean magnitudes of the contrasts that the target reported, in increasing order
  std::vector<MrtdPoint> bars{};     ///< x before y, low frequencies first
  std::vector<MrtdPoint> spots{};    ///< small spots first
  std::vector<std::string> reasons{};  ///< sentences about bars and spots that could not be judged
  KeptBars kept{};                     ///< windows for human observers; empty unless kept_frames is above 0

  /// Returns the bars on this axis with the frequency nearest to the requested frequency; null if there are none.
  [[nodiscard]] const MrtdPoint* stated(EdgeAxis axis) const;
  /// Returns the spot with the side nearest to the requested side; null if there is none.
  [[nodiscard]] const MrtdPoint* stated_spot() const;
};

/// Highest frequency of an MRTD: the Nyquist frequency with a margin for the error of the scale. Above the Nyquist
/// frequency, a model observer still discriminates the alias patterns of the bars, but a person does not see four bars.
inline constexpr double mrtd_cut_per_pitch = 0.505;

/// The two alternatives of Bijl and Valeton: a group of four bars and a group of five bars in squares of the same size.
struct BarPair {
  PlateBars four;
  std::string five;                       ///< name of the group of five
  std::vector<PlateRectangle> five_bars;  ///< rectangles "NAME, bar 1" to "NAME, bar 5"
  cv::Point2d five_mm;                    ///< middle of their square
};
/// Returns each group of four bars of a plate with the nearest group of five bars on the same axis.
[[nodiscard]] std::vector<BarPair> bar_pairs(const TargetPlate& plate);
/// Returns the rectangles that are not part of a group of five bars.
[[nodiscard]] std::vector<PlateRectangle> spots_of(const TargetPlate& plate);

/// Calls `work`, then shows a state of the target and waits until frames of this state can be taken. Frames that arrive
/// during `work` are read from the camera.
using ShowState = std::function<Result<PresentedTarget>(const TargetState&, const std::function<void()>& work)>;

/// A state that the measurement shows. In each mounting, the first state has the contrast at which the plate is
/// located. The next states show all contrasts at the set-ups of this mounting, from large to small and with both
/// polarities.
struct MrtdPresentation {
  TargetState state;
  int set_up = 0;         ///< negative: the plate is located
  std::size_t level = 0;  ///< index in MrtdOptions::contrasts_k
};
/// Returns the presentations in order. `pixel_mm`: size of a pixel on the plate.
[[nodiscard]] std::vector<MrtdPresentation> mrtd_presentations(const MrtdOptions& options, double pixel_mm);

/// Measures the MRTD. A decision compares two intervals: one with four bars, and one with five bars in a square of the
/// same size and with the same contrast. The observer states which interval had four bars, which avoids a response bias
/// (Bijl and Valeton 1999). Every frame shows both groups. All pairs of frames are judged, as in virtual_mrtd(). The
/// threshold of each polarity is computed from a fitted function of contrast (fit_contrast()). The result is half of
/// the difference of the two thresholds, in which the offset of the target cancels. The interval is computed by
/// jackknife over the set-ups, with Student's t. Spots are compared with an empty part of the plate.
///
/// `where`: registration of a plate in the same holder, in identity mounting. The plate of the MRTD is located to a
/// whole pixel, and the observer searches for the remaining shift. An observer of limited efficiency enlarges the noise
/// of the camera. This noise is measured in the frames in which the plate is located. Errors: those of target and
/// camera, `calibration` (plate not in the picture), `invalid_input` (no pair of groups that can be judged).
[[nodiscard]] Result<MrtdMeasure> measure_mrtd(FrameTaker& taker, const ShowState& show, const Registration& where,
                                               const MrtdOptions& options, std::stop_token stop);

}  // namespace todbench
