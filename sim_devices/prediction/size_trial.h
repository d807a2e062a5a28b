// SPDX-License-Identifier: GPL-3.0-or-later
// Proportion correct for one target size with a simulated sensor and a searching observer, without frames.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "acquisition/base/result.h"
#include "acquisition/base/rng.h"
#include "hvs/observer/template_bank.h"
#include "hvs/observer/template_observer.h"
#include "sim_devices/prediction/score_turns.h"
#include "sim_devices/sensor/effect_row.h"
#include "sim_devices/sensor/image_chain.h"

namespace todbench {

/// Proportion correct at one size with its variance.
struct Proportion {
  double mean = 0, variance = 0;
};

/// Orientations that are shown.
enum class ShownOrientations {
  as_needed,  ///< one orientation represents all four if no effect depends on direction
  all,        ///< all four orientations; needed to compare conditions draw by draw if one of them needs all
};

/// Fails with `invalid_input` if the sample aspect of the observer differs from the pitch aspect of the sensor.
[[nodiscard]] Result<void> check_sample_shape(const SensorSpec& sensor, const TemplateObserverSpec& observer);

/// Conditions that all sizes and contrasts share.
struct TrialConditions {
  SensorSpec sensor;  ///< sensor as planned
  SceneMotion motion{};
  int samples_per_pitch = 1;           ///< displayed samples per detector pitch and axis
  int phases_per_axis = 8;             ///< sampling phases per pitch along each axis
  double search_step_samples = 0.125;  ///< step of the search over positions, in displayed samples
  ShownOrientations orientations = ShownOrientations::as_needed;
  bool by_pixels = false;  ///< true if pixel_proportion() will be called
};

/// One contrast of a camera whose counts are too coarse or too few for this contrast.
struct PixelContrast {
  double scene_k = 0;     ///< true contrast, triangle minus surround
  double seen_k = 0;      ///< reading of the camera, by which the observer divides
  double noise_k = 0;     ///< white noise of a sample before display and rounding, averaged over exposures
  double internal_k = 0;  ///< white noise of the observer
  double background_k = 300;
};

/// White noise per sample, relative to the contrast.
struct WhiteNoise {
  double sensor = 0;    ///< temporal noise and quantisation, averaged over exposures; filtered by the display
  double internal = 0;  ///< noise of the observer
};

/// Responses to the signal for every sampling phase, and projected noise. Each response is computed once and shared by
/// the contrasts. Every kind of noise has its own random numbers, so leaving out one kind does not change the others.
/// Rotated, mirrored or negated white noise is equally probable; its scores are those of exchanged templates. Each draw
/// is therefore used in all sixteen ways, each way in a sixteenth of the phases. A bank without this symmetry
/// (ScoreTurns) allows two ways, each in all phases. One thread at a time.
class SizeTrial {
 public:
  SizeTrial(const ImageChain& chain, std::shared_ptr<const TemplateBank> bank, double size_pitch,
            const TrialConditions& conditions, RandomStream stream);

  /// Returns the proportion correct at the contrast `contrast_k` > 0; `white` is relative to this contrast.
  [[nodiscard]] Proportion proportion(const WhiteNoise& white, double contrast_k, int draws);

  /// Returns the proportion correct with the counts of the sensor: every pixel of every trial is rounded and clipped.
  /// Each draw is used in as many phases as one axis has; successive draws cycle through all phases. Each axis has
  /// twice as many phases as in proportion(). Precondition: conditions.by_pixels.
  [[nodiscard]] Proportion pixel_proportion(const PixelContrast& contrast, int draws);

  /// Returns the proportion correct of an observer that knows the position (to half a search step). `noise`: sd of the
  /// white noise relative to the contrast; `eye_sd`: sd of the noise of the eye in a score; `nodes`: number of
  /// quadrature nodes. No draws: the only error is that of the quadrature (known_position.h).
  [[nodiscard]] double known_position_proportion(double noise, int nodes, double eye_sd = 0) const;

  /// Returns the variance of the score difference between two templates, for noise of sd 1 in which the samples
  /// selected by `shared` have the same random number. The variance is divided by its value for white noise of sd 1.
  /// The result is the largest ratio over the pairs of alternatives, at the middle of the search.
  [[nodiscard]] double variance_ratio(SharedBy shared) const;
  /// Returns the standard deviation of the noise of the eye in a score, in units of the contrast. 0 without an eye.
  [[nodiscard]] double eye_sd(double contrast_k) const;
  /// Returns the variance per sample of white noise that changes a score difference as much as the noise of the
  /// observer's eye, in units of the contrast squared. The result is the smallest variance over the pairs of
  /// alternatives, at the middle of the search; 0 without an eye.
  [[nodiscard]] double eye_variance(double contrast_k) const;

 private:
  /// Converts the products of four templates, `gram`, to score covariances in white noise and noise of the eye.
  void add_eye_gram(double noise, double eye_sd, std::array<std::array<double, 4>, 4>& gram) const;
  struct Response {
    int truth = 0;              ///< the alternative that is shown
    int place = 0;              ///< number of the search position next to the true position
    std::vector<float> patch;   ///< samples; only with dead detectors or by_pixels
    std::vector<float> scores;  ///< scores of all templates
    cv::Mat1f before_display;   ///< samples with a margin for the display's taps; only with by_pixels
  };
  /// Returns the result of one trial of pixel_proportion(): 1, 0, or 1 / n for a tie of n alternatives.
  [[nodiscard]] double pixel_trial(const Response& response, const PixelContrast& contrast, std::uint64_t index) const;
  struct FineFields;
  [[nodiscard]] Response response(const FineFields& fields, int per_pitch, cv::Point phase, int per_axis,
                                  std::uint64_t number) const;
  [[nodiscard]] int phases_per_sample() const;  ///< per axis
  /// Draws noise until there are `draws` draws.
  void draw_up_to(std::size_t draws);
  [[nodiscard]] cv::Mat1f coloured(std::uint64_t index, int window) const;
  [[nodiscard]] cv::Mat1b dead(std::uint64_t index, int window) const;
  [[nodiscard]] std::vector<float> projected(const cv::Mat1f& samples) const;
  void shape_white(const WhiteNoise& white);
  /// Returns the scores of the noise of the eye with standard deviation `sd`, for draw or trial `index`; zeros without
  /// an eye.
  [[nodiscard]] std::vector<float> eye_scores(std::uint64_t index, double sd) const;
  /// Returns 1 if the true alternative wins, 1 / n if it ties with n - 1 others, and otherwise 0.
  [[nodiscard]] double correct(int truth, std::span<const float> signal, std::span<const float> noise,
                               float scale) const;
  /// Returns the share of correct answers over the phases and the ways of using a draw. White noise is multiplied by
  /// `own`, coloured noise by `ratio`, noise of the eye by `eye`, and their sum by `scale`.
  [[nodiscard]] double share_in_all_ways(std::size_t draw, float own, float scale, float ratio, float eye);
  /// Returns the scores of a response whose picture has `defects` replaced.
  [[nodiscard]] std::vector<float> with_defects(const Response& response, const cv::Mat1b& defects) const;

  std::shared_ptr<const TemplateBank> bank_;
  TrialConditions conditions_;
  RandomStream stream_;
  std::vector<const stage::Noise*> coloured_stages_;  ///< coloured noise of this sensor
  std::vector<double> display_taps_;                  ///< empty for sample-and-hold
  std::vector<double> white_taps_;   ///< taps for the sum of the noise of sensor and observer; empty without display
  double white_ratio_ = -1;          ///< ratio to which white_taps_ belong
  int places_of_dance_ = 1;          ///< displacements by image dance for each phase
  std::vector<Response> responses_;  ///< responses by shown orientation, position of the dance and phase
  ScoreTurns turns_;
  std::vector<std::vector<std::uint32_t>> phase_group_;  ///< response indices by group; phases evenly spread
  std::vector<std::uint32_t> every_response_;
  std::vector<float> turned_;                          ///< scratch
  std::vector<std::vector<float>> noise_;              ///< projected white noise of sd 1, by draw
  std::vector<std::vector<float>> eye_;                ///< scores of the noise of the eye with sd 1, by draw
  std::vector<float> mixed_;                           ///< scratch
  std::vector<std::vector<float>> coloured_;           ///< projected coloured noise in kelvin, by draw
  std::map<double, std::vector<double>> pixel_draws_;  ///< proportion correct of each draw, by contrast of the scene
};

}  // namespace todbench
