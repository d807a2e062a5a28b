// One target size before a simulated sensor and a searching observer: proportion correct without frames.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "acquisition/core/rng.h"
#include "hvs/observer/template_bank.h"
#include "sim_devices/sensor/effect_row.h"
#include "sim_devices/sensor/image_chain.h"

namespace todbench {

/// Proportion correct at one size with its variance.
struct Proportion {
  double mean = 0, variance = 0;
};

/// Which of the alternatives are shown.
enum class ShownOrientations {
  as_needed,  ///< one stands for all four where nothing tells them apart
  all,        ///< for comparisons draw by draw between conditions that need one and conditions that need all
};

/// What is the same for all sizes and contrasts.
struct TrialConditions {
  SensorSpec sensor;  ///< as planned
  SceneMotion motion{};
  int samples_per_pitch = 1;
  int phases_per_axis = 8;  ///< per pitch
  double search_step_samples = 0.125;
  ShownOrientations orientations = ShownOrientations::as_needed;
  bool by_pixels = false;  ///< pixel_proportion() will be asked for
};

/// One contrast of a camera whose counts are too coarse or too few for it.
struct PixelContrast {
  double scene_k = 0;     ///< triangle minus surround, as it is
  double seen_k = 0;      ///< as the camera reads it: what the observer divides by
  double noise_k = 0;     ///< white noise of a sample before display and rounding, exposures averaged
  double internal_k = 0;  ///< white noise of the observer
  double background_k = 300;
};

/// Noise of the white kind per sample, relative to the contrast.
struct WhiteNoise {
  double sensor = 0;    ///< temporal, averaged, and quantisation: passes the display
  double internal = 0;  ///< of the observer
};

/// Responses to the signal for every sampling phase, and projected noise, each formed once and shared by contrasts.
/// Every kind of noise has numbers of its own, so that leaving one out never changes another. White noise is as
/// probable turned, mirrored or with the other sign, and so are its scores with templates exchanged accordingly: a draw
/// is seen in all sixteen ways, each in a sixteenth of the phases. One thread at a time.
class SizeTrial {
 public:
  SizeTrial(const ImageChain& chain, std::shared_ptr<const TemplateBank> bank, double size_pitch,
            const TrialConditions& conditions, RandomStream stream);

  /// At a contrast of `contrast_k` > 0, to which `white` is relative.
  [[nodiscard]] Proportion proportion(const WhiteNoise& white, double contrast_k, int draws);

  /// The same with counts as the sensor makes them: every pixel of every trial is rounded and clipped. Each draw is
  /// seen in as many sampling phases as an axis has, all phases in turn; twice as many phases as without rounding.
  /// Precondition: conditions.by_pixels.
  [[nodiscard]] Proportion pixel_proportion(const PixelContrast& contrast, int draws);

  /// The proportion of an observer that knows the position (to half a search step) in white noise of sd `noise`
  /// relative to the contrast: exact, without draws (known_position.h).
  [[nodiscard]] double known_position_proportion(double noise, int nodes) const;

  /// Variance of the difference between the true template's score and another's, for numbers of sd 1 that samples
  /// share so, over that for white noise of sd 1: the largest over the alternatives, at the middle of the search.
  [[nodiscard]] double variance_ratio(SharedBy shared) const;

 private:
  struct Response {
    int truth = 0;              ///< the alternative that is shown
    int place = 0;              ///< search place next to the true position
    std::vector<float> patch;   ///< samples; only where detectors are dead or pixels are asked for
    std::vector<float> scores;  ///< of all templates
    cv::Mat1f before_display;   ///< samples with a margin of the display's taps; only where pixels are asked for
  };
  /// What one trial of pixel_proportion() comes to: 1, 0, or the fair part of a tie.
  [[nodiscard]] double pixel_trial(const Response& response, const PixelContrast& contrast, std::uint64_t index) const;
  [[nodiscard]] Response response(const cv::Mat1d& fine, int per_pitch, cv::Point phase, int per_axis,
                                  std::uint64_t number) const;
  [[nodiscard]] int phases_per_sample() const;  ///< per axis
  /// Draws noise until there is enough for so many.
  void draw_up_to(std::size_t draws);
  [[nodiscard]] cv::Mat1f coloured(std::uint64_t index, int window) const;
  [[nodiscard]] cv::Mat1b dead(std::uint64_t index, int window) const;
  [[nodiscard]] std::vector<float> projected(const cv::Mat1f& samples) const;
  void shape_white(const WhiteNoise& white);
  /// 1 where the true alternative wins, the fair part of a tie.
  [[nodiscard]] double correct(int truth, std::span<const float> signal, std::span<const float> noise,
                               float scale) const;
  /// Share of the phases and of the ways in which a draw can be seen. White noise counts `own` times, `coloured` noise
  /// `ratio` times.
  [[nodiscard]] double share_in_all_ways(std::size_t draw, float own, float scale, float ratio);
  /// The scores of a response whose picture has `defects` replaced.
  [[nodiscard]] std::vector<float> with_defects(const Response& response, const cv::Mat1b& defects) const;
  void find_turns();
  /// turned_: the noise of a draw as that turn has it. `across` holds the transposed noise where a turn needs it.
  void turn_noise(const std::vector<float>& noise, const std::vector<float>& across, std::size_t turn, float own);

  std::shared_ptr<const TemplateBank> bank_;
  TrialConditions conditions_;
  RandomStream stream_;
  std::vector<const stage::Noise*> coloured_stages_;  ///< what this sensor has of noise that is not white
  std::vector<double> display_taps_;                  ///< empty for sample and hold
  std::vector<double> white_taps_;   ///< of sensor's and internal noise together; empty without display
  double white_ratio_ = -1;          ///< for which white_taps_ are
  int places_of_dance_ = 1;          ///< at every phase
  std::vector<Response> responses_;  ///< per orientation that counts, place of the dance and phase
  /// Which template's score each template gets: of alternative from[o] at the place that is found so.
  struct Turn {
    std::array<int, 4> from{0, 1, 2, 3};
    bool transposed = false, rows_reversed = false, columns_reversed = false;  ///< in this order
  };
  std::vector<Turn> turns_;                              ///< the identity first
  std::vector<std::vector<std::uint32_t>> phase_group_;  ///< responses by group: phases of one lie evenly in the pixel
  std::vector<std::uint32_t> every_response_;
  std::vector<float> turned_, across_;                 ///< scratch
  std::vector<std::vector<float>> noise_;              ///< per draw, unit white noise projected
  std::vector<std::vector<float>> coloured_;           ///< per draw, noise that is not white, in kelvin projected
  std::map<double, std::vector<double>> pixel_draws_;  ///< by contrast of the scene, proportion of each draw
};

}  // namespace todbench
