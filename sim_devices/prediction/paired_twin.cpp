// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/prediction/paired_twin.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <tuple>

#include "acquisition/base/rng.h"
#include "acquisition/base/try.h"
#include "sim_devices/sensor/effect_display.h"
#include "sim_devices/sensor/effect_readout.h"
#include "sim_devices/sensor/image_chain.h"
#include "sim_devices/sensor/sensor_model.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

using SetUpKey = std::pair<std::string, Mounting>;

/// Exposures between two pictures of one model: enough for noise with memory to become independent.
constexpr std::uint64_t apart = 1000;

/// Place of one window of a presentation in the picture of all its windows.
struct Tile {
  cv::Rect window;  ///< part that the observer judges
  cv::Rect whole;   ///< with the margin that display and dead pixels need
};

/// The windows of a presentation side by side.
struct Tiles {
  std::vector<Tile> tiles;
  cv::Size size;  ///< in samples, whole detectors
};

Tiles laid_out(const std::vector<int>& sides, int margin, int samples_per_pitch) {
  const auto whole_detectors = [&](int samples) {
    return (samples + samples_per_pitch - 1) / samples_per_pitch * samples_per_pitch;
  };
  constexpr std::size_t columns = 5;
  Tiles out;
  int x = 0, y = 0, height = 0;
  for (std::size_t i = 0; i < sides.size(); ++i) {
    if (i % columns == 0) {
      y += height;
      x = height = 0;
    }
    const int side = sides[i], whole = whole_detectors(side + 2 * margin);
    out.tiles.push_back({{x + margin, y + margin, side, side}, {x, y, whole, whole}});
    x += whole;
    height = std::max(height, whole);
    out.size = {std::max(out.size.width, x), y + height};
  }
  return out;
}

Polygon rotated_by(const Polygon& polygon, double degrees) {
  const double angle = degrees * std::numbers::pi / 180;
  Polygon out;
  for (const auto& v : polygon)
    out.emplace_back(v.x * std::cos(angle) - v.y * std::sin(angle), v.x * std::sin(angle) + v.y * std::cos(angle));
  return out;
}

class PairedTwin {
 public:
  PairedTwin(const SensorSpec& sensor, const SensorPlan& effects, Observer& observer, const PairedTwinOptions& options)
      : sensor_(as_planned(sensor, effects)),
        effects_(effects),
        observer_(observer),
        options_(options),
        chain_(sensor_, effects, options.accuracy, options.motion),
        noise_(options.seed, "paired.sensor"),
        answers_(options.seed, "paired.observer") {
    if (has_display(sensor_))
      margin_ = static_cast<int>(taps_of([&](double f) { return display_response(sensor_, f); }).size()) / 2;
    if (sensor_.dead_pixel_share > 0) margin_ = std::max(margin_, 2 * sensor_.samples_per_pitch());
  }

  /// Answers to the trials of one presentation.
  Result<std::vector<TwinAnswer>> answers(std::span<const Trial> shown) {
    std::vector<std::shared_ptr<const PreparedObserver>> observers;
    std::vector<int> sides;
    for (const Trial& trial : shown) {
      if (!(trial.size_mrad > 0) || !std::isfinite(trial.delta_t_k) || trial.delta_t_k == 0)
        return fail(ErrorCode::invalid_input, "a trial without size or contrast cannot be shown to the twin");
      const int n = sensor_.samples_per_pitch();
      TODBENCH_TRY(auto prepared, observer_.prepare(trial.size_mrad / sensor_.ifov_mrad() * n, n));
      sides.push_back(prepared->window_samples());
      observers.push_back(std::move(prepared));
    }
    const Tiles tiles = laid_out(sides, margin_, sensor_.samples_per_pitch());
    const SetUpKey set_up{shown.front().plate, shown.front().mounting};
    const auto& models = models_of(set_up, tiles.size);
    const cv::Mat1f unit = unit_signal(shown, tiles, rotation_of(set_up));
    return judged(shown, observers, tiles, models, unit);
  }

 private:
  using Models = std::vector<std::unique_ptr<const SensorModel>>;

  [[nodiscard]] double rotation_of(const SetUpKey& set_up) const {
    const auto found = options_.rotations_deg.find(set_up);
    return found == options_.rotations_deg.end() ? 0 : found->second;
  }

  /// Models for the draws, each with its own fixed pattern.
  const Models& models_of(const SetUpKey& set_up, cv::Size size) {
    auto [slot, is_new] = models_.try_emplace({set_up, size.width, size.height});
    if (!is_new) return slot->second;
    SensorSpec small = sensor_;
    small.width = size.width / sensor_.samples_per_pitch();
    small.height = size.height / sensor_.samples_per_pitch();
    const RandomStream own = noise_.sub(models_.size());
    for (int draw = 0; draw < options_.draws; ++draw) {
      const auto words = own.sub(static_cast<std::uint64_t>(draw)).words(0);
      const std::uint64_t seed = (std::uint64_t{words[0]} << 32) | words[1];
      slot->second.push_back(std::make_unique<const SensorModel>(small, effects_, options_.accuracy, seed));
    }
    return slot->second;
  }

  const PolygonImage& image_of(const Trial& trial, double rotation_deg) {
    auto& slot = images_[{trial.size_mrad, static_cast<int>(trial.truth), rotation_deg}];
    if (!slot)
      slot = std::make_unique<const PolygonImage>(chain_.image(on_detectors(
          rotated_by(triangle(trial.size_mrad / sensor_.ifov_mrad(), trial.truth), rotation_deg), sensor_)));
    return *slot;
  }

  cv::Mat1f unit_signal(std::span<const Trial> shown, const Tiles& tiles, double rotation_deg) {
    cv::Mat1f unit(tiles.size, 0.0F);
    const double sample = 1.0 / sensor_.samples_per_pitch();
    for (std::size_t i = 0; i < shown.size(); ++i) {
      const cv::Rect window = tiles.tiles[i].window, whole = tiles.tiles[i].whole;
      // The middle of the window is a corner between four samples; the triangle is displaced from it by `phase`.
      const double first = -0.5 * (window.width - 1) - margin_;
      const cv::Point2d corner((first - shown[i].phase_x_px) * sample, (first - shown[i].phase_y_px) * sample);
      const PolygonImage& image = image_of(shown[i], rotation_deg);
      const cv::Mat1d samples = in_fields(
          way_between_fields(sensor_, options_.motion), sensor_.samples_per_pitch(),
          [&](cv::Point2d displacement) { return image.sample(corner - displacement, sample, whole.size()); });
      samples.convertTo(unit(whole), CV_32F);
    }
    return unit;
  }

  /// Noise of a sample as known to an observer of limited efficiency: from two pictures of each of a few models.
  double noise_k(const Models& models, const cv::Mat1f& unit, double contrast_k) {
    if (noise_k_) return *noise_k_;
    constexpr std::size_t enough = 8;
    double squares = 0, count = 0;
    for (std::size_t k = 0; k < std::min(enough, models.size()); ++k) {
      const cv::Mat1f difference = models[k]->picture(unit, contrast_k, sensor_.scene_temperature_k, apart / 2) -
                                   models[k]->picture(unit, contrast_k, sensor_.scene_temperature_k, 2 * apart);
      squares += difference.dot(difference) / 2;
      count += static_cast<double>(difference.total());
    }
    noise_k_ = std::sqrt(squares / count);
    return *noise_k_;
  }

  Result<std::vector<TwinAnswer>> judged(std::span<const Trial> shown,
                                         const std::vector<std::shared_ptr<const PreparedObserver>>& observers,
                                         const Tiles& tiles, const Models& models, const cv::Mat1f& unit) {
    const double contrast_k = shown.front().delta_t_k;
    const double own_noise_k = noise_k(models, unit, contrast_k);
    const auto presentation = static_cast<std::uint64_t>(shown.front().presentation);
    std::vector<double> sums(shown.size()), squares(shown.size());
    for (std::size_t draw = 0; draw < models.size(); ++draw) {
      if (options_.stop.stop_requested()) return fail(ErrorCode::interrupted, "stopped on request");
      const cv::Mat1f picture =
          models[draw]->picture(unit, contrast_k, sensor_.scene_temperature_k, (presentation + 3) * apart);
      for (std::size_t i = 0; i < shown.size(); ++i) {
        Patch patch{.kelvin = {}, .phase = {shown[i].phase_x_px, shown[i].phase_y_px}, .noise_k = own_noise_k};
        picture(tiles.tiles[i].window).convertTo(patch.kelvin, CV_64F);
        const RandomStream noise = answers_.sub(presentation).sub(i).sub(draw);
        const GradedChoice found = observers[i]->judge(patch, contrast_k, noise, options_.graded_draws);
        const double right = found.answers.probability[static_cast<std::size_t>(shown[i].truth)];
        sums[i] += right;
        squares[i] += right * right;
      }
    }
    const auto n = static_cast<double>(models.size());
    std::vector<TwinAnswer> out;
    for (std::size_t i = 0; i < shown.size(); ++i) {
      const double mean = sums[i] / n;
      const double scatter = std::max(0.0, squares[i] / n - mean * mean) / (n - 1);
      out.push_back({.probability_correct = std::clamp(mean, 0.0, 1.0), .variance = scatter});
    }
    return out;
  }

  SensorSpec sensor_;
  const SensorPlan& effects_;
  Observer& observer_;
  const PairedTwinOptions& options_;
  ImageChain chain_;
  RandomStream noise_, answers_;
  int margin_ = 0;
  std::map<std::tuple<SetUpKey, int, int>, Models> models_;
  std::map<std::tuple<double, int, double>, std::unique_ptr<const PolygonImage>> images_;
  std::optional<double> noise_k_;
};

}  // namespace

Result<std::vector<TwinAnswer>> twin_answers(const SensorSpec& sensor, const SensorPlan& effects, Observer& observer,
                                             std::span<const Trial> trials, const PairedTwinOptions& options) {
  if (options.draws < 2) return fail(ErrorCode::invalid_input, "the twin needs at least two noise draws");
  PairedTwin twin(sensor, effects, observer, options);
  std::vector<TwinAnswer> out;
  for (std::size_t first = 0; first < trials.size();) {
    std::size_t end = first + 1;
    while (end < trials.size() && trials[end].presentation == trials[first].presentation) ++end;
    TODBENCH_TRY(auto answers, twin.answers(trials.subspan(first, end - first)));
    out.insert(out.end(), answers.begin(), answers.end());
    first = end;
  }
  return out;
}

}  // namespace todbench
