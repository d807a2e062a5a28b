// SPDX-License-Identifier: GPL-3.0-or-later
// Judges the bars and spots of a plate with the observer. Computes thresholds from frames. Uses no devices.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "hvs/observer/identification_bank.h"
#include "tod/camera_measures/kept_bars.h"
#include "tod/camera_measures/mrtd_measure.h"
#include "tod/measures/two_intervals.h"

namespace todbench {

/// State of the plate in a frame.
struct ShownBars {
  int set_up = 0;
  std::size_t level = 0;  ///< index of the contrast
  double said_k = 0;      ///< reported by the target, signed
  Mounting mounting = Mounting::identity;
  Registration where;  ///< registration of the plate in this mounting and position
  double noise_k = 0;  ///< temporal noise of the camera, sd of a pixel in one frame
};

/// Judges frames one by one and computes the thresholds.
class BarsJudge {
 public:
  /// Prepares the observer. `where`: registration of the plate in identity mounting, for scale and direction. Errors:
  /// `invalid_input` (no pair that can be judged), and those of the observer's templates.
  [[nodiscard]] static Result<BarsJudge> create(const MrtdOptions& options, const Registration& where);
  /// Judges all bars and spots in one frame. Bars or spots whose window is partly outside the picture are excluded from
  /// all later frames.
  void add(const cv::Mat1d& kelvin, const ShownBars& shown);
  [[nodiscard]] MrtdMeasure result() const;

 private:
  /// Scores of one polarity for intervals with the target and with the alternative: [level][set-up][draw].
  struct Scores {
    std::vector<IntervalScores> target, other;
  };
  /// Answers of one observer.
  struct Answers {
    Scores positive{}, negative{};
  };
  /// A target with its alternative on the plate.
  struct Place {
    std::string name{};
    EdgeAxis axis = EdgeAxis::x;
    double frequency_per_pitch = 0, size_px = 0;
    std::optional<IdentificationBank> bank{};
    std::vector<std::vector<float>> own_noise{};  ///< scores of white noise of sd 1
    std::vector<std::vector<float>> eye_noise{};  ///< scores of the noise of the eye of sd 1; empty without an eye
    std::vector<Answers> answers{};               ///< answers of each observer
    std::vector<double> phase{};                  ///< sampling phase of the target across the bars, by set-up
    bool left_out = false;
  };
  struct Thresholds;
  /// Data that are left out: one set-up, or one part of the frames of every set-up. By default no data are left out.
  struct LeftOut {
    static constexpr std::size_t none = -1;
    std::size_t set_up = none, frame_part = none;
    /// Returns the first `draws` elements of a row, without those of the left-out part.
    [[nodiscard]] std::vector<float> rest(const std::vector<float>& row, std::size_t draws) const;
  };

  explicit BarsJudge(const MrtdOptions& options);
  Result<void> add_place(const PlateRectangle& target, const PlateRectangle& other, Place place,
                         const std::vector<AlternativeAspects>& alternatives);
  /// Adds the scores of every observer for one interval to the scores of this level and set-up. `pattern`: scores of
  /// the window in the frame, in kelvin.
  void decide(Place& place, bool target, const std::vector<float>& pattern, const ShownBars& shown);
  /// Keeps both windows of a frame for human observers. Bars above mrtd_cut_per_pitch have no threshold and are not
  /// kept.
  void keep(std::size_t place, const ShownBars& shown, const cv::Mat1f& target, const cv::Mat1f& other);
  [[nodiscard]] KeptBars kept() const;
  [[nodiscard]] Thresholds thresholds(const Place& place, std::size_t observer, const LeftOut& left_out) const;
  static void find_best_phase(const Answers& answers, const std::vector<double>& phases, const LeftOut& left_out,
                              const std::vector<std::size_t>& levels, Thresholds& out);
  static std::optional<double> jackknife_variance(const std::vector<Thresholds>& left_out,
                                                  std::optional<double> Thresholds::*of);
  [[nodiscard]] MrtdPoint point(const Place& place) const;

  MrtdOptions options_;
  /// The observer of the plan. If it models an eye, then also the best and the worst observer within the range of the
  /// eye's open parameters (open_parameters.h).
  std::vector<TemplateObserverSpec> observers_;
  std::vector<Place> places_;
  /// Rectangles of the targets and alternatives of places_, alternately. mounted() transforms them for each mounting.
  TargetPlate positions_;
  std::vector<double> said_sum_k_;
  std::vector<int> said_count_;
  std::vector<std::string> reasons_;
  std::uint64_t draws_ = 0;
  BarsKeeper keeper_;
};

}  // namespace todbench
