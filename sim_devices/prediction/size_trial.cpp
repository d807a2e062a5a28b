// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/prediction/size_trial.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "hvs/observer/eye_noise.h"
#include "hvs/observer/known_position.h"
#include "hvs/observer/share_won.h"
#include "sim_devices/sensor/effect_dead_pixels.h"
#include "sim_devices/sensor/effect_display.h"
#include "sim_devices/sensor/effect_image_dance.h"
#include "sim_devices/sensor/effect_quantisation.h"
#include "sim_devices/sensor/effect_readout.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

// Sub-streams of one draw; each kind of noise has its own.
std::uint64_t white_part(std::uint64_t draw) {
  return 2 * draw;
}
std::uint64_t pattern_part(std::uint64_t draw) {
  return 2 * draw + 1;
}
/// Stream for dead detectors and for lines, three per draw.
std::uint64_t rare_part(std::uint64_t draw, std::uint64_t part) {
  return (std::uint64_t{1} << 40) + 3 * draw + part;
}

/// Stream of the observer, for trials of pixels.
std::uint64_t observer_part(std::uint64_t trial) {
  return (std::uint64_t{1} << 42) + trial;
}

/// Stream of the observer's eye.
std::uint64_t eye_part(std::uint64_t draw) {
  return (std::uint64_t{1} << 43) + draw;
}

/// Named stream of one draw.
RandomStream named(const RandomStream& stream, std::uint64_t draw, std::string_view name) {
  if (name == "fixed") return stream.sub(pattern_part(draw));
  if (name == "rows") return stream.sub(rare_part(draw, 0));
  if (name == "columns") return stream.sub(rare_part(draw, 1));
  if (name == "dead") return stream.sub(rare_part(draw, 2));
  return {stream.sub((std::uint64_t{1} << 41) + draw).stream(), name};
}

/// Adds in the order of the samples, in double precision. cv::Mat::dot() adds in single precision and in an order that
/// depends on the processor; the covariance of nearly equal templates enlarges that to 5e-6 of a threshold.
double sum_of_products(const cv::Mat1f& a, const cv::Mat1f& b) {
  double sum = 0;
  for (int row = 0; row < a.rows; ++row) {
    for (int column = 0; column < a.cols; ++column)
      sum += static_cast<double>(a(row, column)) * static_cast<double>(b(row, column));
  }
  return sum;
}

/// Map of dead detectors for the noise in way `turn` (of ScoreTurns): T(turned) . w is T . (w turned back).
cv::Mat1b dead_turned_back(const cv::Mat1b& map, std::size_t turn) {
  cv::Mat1b back = map;
  if (turn >= 4) cv::flip(map, back, 1);
  for (std::size_t k = 0; k < turn % 4; ++k) {
    cv::Mat1b next;
    cv::rotate(back, next, cv::ROTATE_90_COUNTERCLOCKWISE);
    back = next;
  }
  return back;
}

}  // namespace

Result<void> check_sample_shape(const SensorSpec& sensor, const TemplateObserverSpec& observer) {
  if (sensor.pitch_aspect() == observer.sample_aspect) return {};
  return fail(
      ErrorCode::invalid_input,
      fmt::format("observer {} judges samples {:g} times as high as wide, but the pitches of sensor {} differ by "
                  "a factor of {:g}",
                  observer.name, observer.sample_aspect, sensor.name, sensor.pitch_aspect()));
}

/// Picture of a shape for the even and the odd rows of detectors; `odd` is empty if they sample together.
struct SizeTrial::FineFields {
  cv::Mat1d even, odd;

  /// The picture for a row of samples of the window; rows above it are negative. The field of the first row alternates
  /// between neighbouring phases, because both fields are equally frequent in a session.
  [[nodiscard]] const cv::Mat1d& of_row(int row, int samples_per_pitch, cv::Point phase) const {
    const int detector_row = static_cast<int>(std::floor(static_cast<double>(row) / samples_per_pitch));
    return odd.empty() || (detector_row + phase.x + phase.y) % 2 == 0 ? even : odd;
  }
};

SizeTrial::SizeTrial(const ImageChain& chain, std::shared_ptr<const TemplateBank> bank, double size_pitch,
                     const TrialConditions& conditions, RandomStream stream)
    : bank_(std::move(bank)), conditions_(conditions), stream_(stream), turns_(*bank_) {
  const SensorSpec& sensor = conditions_.sensor;
  bool turns_alike = sensor.square_detector();
  for (const Effect effect : all_effects) {
    const EffectRow& row = row_of(effect);
    if (is_neutral(sensor, effect, conditions_.motion)) continue;
    turns_alike = turns_alike && row.directions == AxisDirections::alike;
    const auto* noise = std::get_if<stage::Noise>(&row.stage);
    if (noise != nullptr && noise->colour == stage::Colour::coloured) coloured_stages_.push_back(noise);
  }
  if (has_display(sensor)) display_taps_ = taps_of([&](double f) { return display_response(sensor, f); });
  // The sampling grid and most effects are the same from all four sides.
  const bool alike = conditions_.orientations == ShownOrientations::as_needed && turns_alike;
  const int per_axis = phases_per_sample();
  const int per_pitch = chain.points_per_pitch() * (conditions_.by_pixels ? 2 : 1);
  // Distance in pitches from the middle that contains the samples of the window and of the display's filter.
  const int margin = static_cast<int>(display_taps_.size()) / 2;
  const int reach = (bank_->window_samples() / 2 + margin) / conditions_.samples_per_pitch + 2 +
                    static_cast<int>(std::ceil(4 * dance_sd_pitch(sensor)));
  places_of_dance_ = dances_per_phase(sensor, conditions_.phases_per_axis);
  const int truths = alike ? 1 : bank_->alternatives();
  const cv::Point2d way = way_between_fields(sensor, conditions_.motion);
  for (int truth = 0; truth < truths; ++truth) {
    const auto fine_at = [&](cv::Point2d place) {
      const Polygon shape = on_detectors(triangle(size_pitch, all_apexes[static_cast<std::size_t>(truth)]), sensor);
      return chain.image(placed(shape, 1, place)).fine_image(per_pitch, reach);
    };
    const FineFields fine{fine_at(-0.5 * way), way == cv::Point2d(0, 0) ? cv::Mat1d() : fine_at(0.5 * way)};
    for (int danced = 0; danced < places_of_dance_; ++danced) {
      for (int phase = 0; phase < per_axis * per_axis; ++phase) {
        const auto number = static_cast<std::uint64_t>((danced * truths + truth) * per_axis * per_axis + phase);
        responses_.push_back(response(fine, per_pitch, {phase % per_axis, phase / per_axis}, per_axis, number));
        responses_.back().truth = truth;
      }
    }
  }
  int groups_per_axis = std::min(per_axis, 4);
  while (per_axis % groups_per_axis != 0) --groups_per_axis;
  phase_group_.resize(static_cast<std::size_t>(places_of_dance_ * groups_per_axis * groups_per_axis));
  for (std::uint32_t k = 0; k < responses_.size(); ++k) {
    const int phase = static_cast<int>(k) % (per_axis * per_axis);
    const int danced = static_cast<int>(k) / (per_axis * per_axis) % places_of_dance_;
    const int group = phase / per_axis % groups_per_axis * groups_per_axis + phase % per_axis % groups_per_axis;
    phase_group_[static_cast<std::size_t>(danced * groups_per_axis * groups_per_axis + group)].push_back(k);
  }
  every_response_.resize(responses_.size());
  std::iota(every_response_.begin(), every_response_.end(), 0U);
}

/// Without noise a rounded picture changes in steps with the phase, so there are twice as many phases.
int SizeTrial::phases_per_sample() const {
  return std::max(1, conditions_.phases_per_axis / conditions_.samples_per_pitch) * (conditions_.by_pixels ? 2 : 1);
}

SizeTrial::Response SizeTrial::response(const FineFields& fields, int per_pitch, cv::Point phase, int per_axis,
                                        std::uint64_t number) const {
  const int window = bank_->window_samples();
  const int stride = per_pitch / conditions_.samples_per_pitch;
  const int margin = static_cast<int>(display_taps_.size()) / 2;
  // Window centre relative to the centroid: -1/2 + (i + 1/2) / per_axis samples; samples at k + 1/2 from it.
  const auto first = [&](int p) { return (2 * p + 1) * stride / (2 * per_axis) - (window / 2 + margin) * stride; };
  cv::Mat1f samples(window + 2 * margin, window + 2 * margin, 0.0F);
  std::vector<cv::Point2d> exposures = spread_dance_pitch(conditions_.sensor, number);
  if (exposures.empty()) exposures.emplace_back(0, 0);
  const auto weight = 1 / static_cast<float>(exposures.size());
  cv::Point2d displaced{0, 0};  // in samples, mean over the exposures
  for (const cv::Point2d& displacement : exposures) {
    const cv::Point moved(static_cast<int>(std::lround(displacement.x * per_pitch)),
                          static_cast<int>(std::lround(displacement.y * per_pitch)));
    displaced += static_cast<double>(weight) / stride * cv::Point2d(moved);
    for (int row = 0; row < samples.rows; ++row) {
      const cv::Mat1d& fine = fields.of_row(row - margin, conditions_.samples_per_pitch, phase);
      const int n = fine.rows;  // the period of a field follows from its displacement
      const int y = ((first(phase.y) + row * stride - moved.y) % n + n) % n;
      for (int column = 0; column < samples.cols; ++column) {
        const int x = ((first(phase.x) + column * stride - moved.x) % n + n) % n;
        samples(row, column) += weight * static_cast<float>(fine(y, x));
      }
    }
  }
  Response out;
  if (conditions_.by_pixels) out.before_display = samples.clone();
  if (margin > 0) samples = filtered(samples, display_taps_)(cv::Rect(margin, margin, window, window)).clone();
  out.scores = projected(samples);
  const int side = static_cast<int>(std::lround(std::sqrt(bank_->places())));
  const auto step = [&](int p, double moved) {
    const double offset = 0.5 - (p + 0.5) / per_axis + moved;  // centroid from the window's centre, in samples
    return std::clamp(static_cast<int>(std::lround(offset / conditions_.search_step_samples)), -(side / 2), side / 2);
  };
  out.place = (step(phase.y, displaced.y) + side / 2) * side + step(phase.x, displaced.x) + side / 2;
  if (conditions_.sensor.dead_pixel_share > 0) out.patch.assign(samples.begin(), samples.end());
  return out;
}

std::vector<float> SizeTrial::projected(const cv::Mat1f& samples) const {
  std::vector<float> scores(bank_->padded_templates());
  bank_->project(std::span(samples.ptr<float>(), samples.total()), scores);
  return scores;
}

double SizeTrial::known_position_proportion(double noise, int nodes, double eye_sd) const {
  CV_Assert(bank_->alternatives() == 4);
  const std::vector<QuadratureNode> rule = gauss_legendre(nodes);
  std::map<int, std::array<std::array<double, 4>, 4>> grams;  // by place
  double sum = 0;
  for (const auto& response : responses_) {
    auto [slot, is_new] = grams.try_emplace(response.place);
    if (is_new) {
      std::array<cv::Mat1f, 4> images;
      for (std::size_t o = 0; o < 4; ++o) images[o] = bank_->image(static_cast<int>(o), response.place);
      for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t j = 0; j < 4; ++j) slot->second[i][j] = sum_of_products(images[i], images[j]);
      }
      if (eye_sd > 0) add_eye_gram(noise, eye_sd, slot->second);
    }
    // The task expects the true alternative first.
    KnownPositionTask task;
    task.noise = eye_sd > 0 ? 1 : noise;
    std::array<std::size_t, 4> order{0, 1, 2, 3};
    std::swap(order[0], order[static_cast<std::size_t>(response.truth)]);
    for (std::size_t i = 0; i < 4; ++i) {
      const auto template_index =
          order[i] * static_cast<std::size_t>(bank_->places()) + static_cast<std::size_t>(response.place);
      task.mean[i] = static_cast<double>(response.scores[template_index]);
      for (std::size_t j = 0; j < 4; ++j) task.gram[i][j] = slot->second[order[i]][order[j]];
    }
    sum += probability_correct(task, rule);
  }
  return sum / static_cast<double>(responses_.size());
}

double SizeTrial::variance_ratio(SharedBy shared_by) const {
  const int n = conditions_.samples_per_pitch;
  double largest = 0;
  for (int first = 0; first < bank_->alternatives(); ++first) {
    for (int other = first + 1; other < bank_->alternatives(); ++other) {
      const cv::Mat1f d = bank_->image(first, bank_->central_place()) - bank_->image(other, bank_->central_place());
      std::map<std::pair<int, int>, double> shared;  // samples with one common offset
      for (int row = 0; row < d.rows; ++row) {
        for (int column = 0; column < d.cols; ++column) {
          const auto key = shared_by == SharedBy::detector ? std::pair(row / n, column / n)
                           : shared_by == SharedBy::row    ? std::pair(row, column % n)
                                                           : std::pair(column, row % n);
          shared[key] += static_cast<double>(d(row, column));
        }
      }
      double variance = 0;
      for (const auto& [key, sum] : shared) variance += sum * sum;
      largest = std::max(largest, variance / sum_of_products(d, d));
    }
  }
  return largest;
}

void SizeTrial::add_eye_gram(double noise, double eye_sd, std::array<std::array<double, 4>, 4>& gram) const {
  const EyeNoise& eye = *bank_->eye();
  const auto places = static_cast<std::size_t>(bank_->places()), middle = places / 2;
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = 0; j < 4; ++j) {
      // Depends on the displacement only, so it is the same at every place.
      const double covariance = eye.covariance(i * places + middle, j * places + middle) / eye.energy();
      gram[i][j] = noise * noise * gram[i][j] + eye_sd * eye_sd * covariance;
    }
  }
}

double SizeTrial::eye_sd(double contrast_k) const {
  const EyeNoise* eye = bank_->eye();
  return eye != nullptr ? eye->sd(contrast_k) : 0;
}

double SizeTrial::eye_variance(double contrast_k) const {
  const EyeNoise* eye = bank_->eye();
  if (eye == nullptr) return 0;
  const auto places = static_cast<std::size_t>(bank_->places()), middle = places / 2;
  double least = std::numeric_limits<double>::infinity();
  for (int first = 0; first < bank_->alternatives(); ++first) {
    for (int other = first + 1; other < bank_->alternatives(); ++other) {
      const cv::Mat1f d = bank_->image(first, bank_->central_place()) - bank_->image(other, bank_->central_place());
      const std::size_t a = static_cast<std::size_t>(first) * places + middle;
      const std::size_t b = static_cast<std::size_t>(other) * places + middle;
      const double moved = eye->covariance(a, a) + eye->covariance(b, b) - 2 * eye->covariance(a, b);
      least = std::min(least, moved / eye->energy() / sum_of_products(d, d));
    }
  }
  return std::pow(eye->sd(contrast_k), 2) * least;
}

std::vector<float> SizeTrial::eye_scores(std::uint64_t index, double sd) const {
  std::vector<float> scores(bank_->padded_templates(), 0.0F);
  const EyeNoise* eye = bank_->eye();
  if (eye == nullptr) return scores;
  std::vector<float> numbers(eye->rank());
  stream_.sub(eye_part(index)).fill_normal(numbers);
  eye->add(numbers, static_cast<float>(sd), scores);
  return scores;
}

/// The sum of sensor's and internal noise is white noise filtered by sqrt((s^2 |D|^2 + i^2) / (s^2 + i^2)).
void SizeTrial::shape_white(const WhiteNoise& white) {
  if (display_taps_.empty()) return;
  const double total = white.sensor * white.sensor + white.internal * white.internal;
  const double ratio = total > 0 ? white.sensor * white.sensor / total : 0;
  if (ratio == white_ratio_) return;
  white_ratio_ = ratio;
  noise_.clear();
  coloured_.clear();
  white_taps_ = taps_of([&](double f) {
    const double display = display_response(conditions_.sensor, f);
    return std::sqrt(ratio * display * display + 1 - ratio);
  });
}

cv::Mat1b SizeTrial::dead(std::uint64_t index, int window) const {
  const double share = conditions_.sensor.dead_pixel_share;
  if (share == 0) return {};
  const int detectors = window / conditions_.samples_per_pitch;
  cv::Mat1b map = dead_detectors({detectors, detectors}, share, named(stream_, index, "dead"));
  return cv::countNonZero(map) > 0 ? map : cv::Mat1b();
}

/// Coloured noise of one draw, in kelvin.
cv::Mat1f SizeTrial::coloured(std::uint64_t index, int window) const {
  const double averaged = 1 / std::sqrt(static_cast<double>(conditions_.sensor.exposures_per_sample()));
  const NoiseStreams streams = [&](std::string_view name, std::uint64_t ago) {
    const RandomStream now = named(stream_, index, name);
    return ago == 0 ? now : now.sub(ago);
  };
  cv::Mat1f samples = cv::Mat1f::zeros(window, window);
  for (const stage::Noise* noise : coloured_stages_) {
    const double weight = noise->recurrence == stage::Recurrence::fixed ? 1 : averaged;
    noise->add(samples, conditions_.sensor, streams, weight);
  }
  return samples;
}

void SizeTrial::draw_up_to(std::size_t draws) {
  const int window = bank_->window_samples();
  // This number fits into the nearest cache with a part of the bank.
  constexpr std::size_t together = 32;
  const auto project = [&](const std::vector<cv::Mat1f>& samples, std::vector<std::vector<float>>& to) {
    std::vector<std::span<const float>> patches;
    std::vector<std::span<float>> scores;
    to.reserve(to.size() + samples.size());
    for (const cv::Mat1f& patch : samples) {
      patches.emplace_back(patch.ptr<float>(), patch.total());
      scores.emplace_back(to.emplace_back(bank_->padded_templates()));
    }
    bank_->project_all(patches, scores);
  };
  while (noise_.size() < draws) {
    std::vector<cv::Mat1f> white, coloured;
    const std::size_t first = noise_.size();
    for (std::size_t index = first; index < std::min(draws, first + together); ++index) {
      const cv::Mat1b defects = dead(index, window);
      const auto seen = [&](cv::Mat1f samples, const std::vector<double>& taps) {
        if (!defects.empty()) replace_dead(samples, defects, conditions_.samples_per_pitch);
        return taps.empty() ? samples : filtered(samples, taps);
      };
      cv::Mat1f numbers(window, window);
      stream_.sub(white_part(index)).fill_normal(std::span(numbers.ptr<float>(), numbers.total()));
      white.push_back(seen(numbers, white_taps_));
      if (!coloured_stages_.empty()) coloured.push_back(seen(this->coloured(index, window), display_taps_));
    }
    project(white, noise_);
    project(coloured, coloured_);
  }
  while (bank_->eye() != nullptr && eye_.size() < draws) eye_.push_back(eye_scores(eye_.size(), 1));
}

Proportion SizeTrial::proportion(const WhiteNoise& white, double contrast_k, int draws) {
  shape_white(white);
  draw_up_to(static_cast<std::size_t>(draws));
  const double total = std::hypot(white.sensor, white.internal);
  // In units of the white noise, or of the contrast if there is none.
  const auto scale = static_cast<float>(total > 0 ? total : 1);
  const auto ratio = static_cast<float>(1 / (contrast_k * static_cast<double>(scale)));
  const float own = total > 0 ? 1.0F : 0.0F;
  const float eye = bank_->eye() != nullptr ? static_cast<float>(bank_->eye()->sd(contrast_k)) / scale : 0.0F;
  double sum = 0, squares = 0;
  for (std::size_t d = 0; d < static_cast<std::size_t>(draws); ++d) {
    const double p = share_in_all_ways(d, own, scale, ratio, eye);
    sum += p;
    squares += p * p;
  }
  const double mean = sum / draws;
  return {mean, std::max(0.0, squares / draws - mean * mean) / std::max(1, draws - 1)};
}

double SizeTrial::share_in_all_ways(std::size_t draw, float own, float scale, float ratio, float eye) {
  turned_.resize(bank_->padded_templates());
  // The noise of the eye is as probable turned or mirrored as white noise.
  if (eye > 0) {
    mixed_.resize(noise_[draw].size());
    for (std::size_t t = 0; t < mixed_.size(); ++t) mixed_[t] = own * noise_[draw][t] + eye * eye_[draw][t];
    own = 1;
  }
  turns_.begin(eye > 0 ? mixed_ : noise_[draw]);
  const cv::Mat1b defects = dead(draw, bank_->window_samples());
  const bool has_coloured = !coloured_stages_.empty();
  // Coloured noise has a direction, and dead detectors were replaced at fixed places.
  const std::size_t turns = has_coloured && !defects.empty() ? 1 : turns_.size();
  double all = 0;
  // Each draw uses other ways for the phases, and continues through the places of the dance.
  const std::size_t ways = 2 * turns;
  std::size_t seen = 0, way = places_of_dance_ > 1 ? draw * ways + draw * ways / phase_group_.size() : draw;
  for (std::size_t turn = 0; turn < turns; ++turn) {
    turns_.turned(turn, turned_);
    for (std::size_t t = 0; own != 1 && t < turned_.size(); ++t) turned_[t] *= own;
    for (std::size_t t = 0; has_coloured && t < turned_.size(); ++t) turned_[t] += ratio * coloured_[draw][t];
    const cv::Mat1b map = defects.empty() ? defects : dead_turned_back(defects, turn);
    for (const float sign : {1.0F, -1.0F}) {
      for (const std::uint32_t k : turns > 1 ? phase_group_[way % phase_group_.size()] : every_response_) {
        const Response& response = responses_[k];
        all += map.empty() ? correct(response.truth, response.scores, turned_, sign * scale)
                           : correct(response.truth, with_defects(response, map), turned_, sign * scale);
        ++seen;
      }
      ++way;
    }
  }
  return all / static_cast<double>(seen);
}

double SizeTrial::pixel_trial(const Response& response, const PixelContrast& contrast, std::uint64_t index) const {
  const int window = bank_->window_samples();
  const int margin = (response.before_display.cols - window) / 2;
  // A whole number of detectors, so that samples share their common numbers.
  const int n = conditions_.samples_per_pitch;
  const int side = (response.before_display.cols + n - 1) / n * n;
  const cv::Rect signal({0, 0}, response.before_display.size());
  cv::Mat1f noise(side, side);
  stream_.sub(white_part(index)).fill_normal(std::span(noise.ptr<float>(), noise.total()));
  noise *= contrast.noise_k;
  if (!coloured_stages_.empty()) noise += coloured(index, side);
  noise(signal) += response.before_display * contrast.scene_k;
  if (const cv::Mat1b defects = dead(index, side); !defects.empty()) replace_dead(noise, defects, n);
  const cv::Mat1f analog = display_taps_.empty() ? noise : filtered(noise, display_taps_);
  const Quantiser quantiser(conditions_.sensor, contrast.background_k);
  cv::Mat1f seen(window, window);
  stream_.sub(observer_part(index)).fill_normal(std::span(seen.ptr<float>(), seen.total()));
  // In units of the contrast, like the scores of the templates.
  const auto internal = static_cast<float>(contrast.internal_k / std::abs(contrast.seen_k));
  const auto per_kelvin = static_cast<float>(1 / contrast.seen_k);
  for (int row = 0; row < window; ++row) {
    for (int column = 0; column < window; ++column) {
      seen(row, column) =
          internal * seen(row, column) + per_kelvin * quantiser.shown(analog(margin + row, margin + column));
    }
  }
  const std::vector<float> scores = projected(seen);
  const double eye_sd = bank_->eye() != nullptr ? bank_->eye()->sd(contrast.seen_k) : 0;
  return correct(response.truth, scores, eye_scores(index, eye_sd), 1.0F);
}

Proportion SizeTrial::pixel_proportion(const PixelContrast& contrast, int draws) {
  CV_Assert(conditions_.by_pixels);
  // Phases along a diagonal: every row and column of phases once per draw, and all of them in turn.
  const int per_axis = phases_per_sample();
  const auto phases = static_cast<std::size_t>(per_axis * per_axis), some = static_cast<std::size_t>(per_axis);
  const auto places = static_cast<std::size_t>(places_of_dance_);
  const std::size_t truths = responses_.size() / phases / places;
  auto& known = pixel_draws_[contrast.scene_k];
  for (std::size_t d = known.size(); d < static_cast<std::size_t>(draws); ++d) {
    double correct = 0;
    for (std::size_t k = 0; k < truths * some; ++k) {
      const std::size_t phase = ((k % some) * (some + 1) + d) % phases;
      const std::size_t danced = (d + d / phases + k) % places;
      correct +=
          pixel_trial(responses_[(k / some * places + danced) * phases + phase], contrast, d * truths * some + k);
    }
    known.push_back(correct / static_cast<double>(truths * some));
  }
  double sum = 0, squares = 0;
  for (std::size_t d = 0; d < static_cast<std::size_t>(draws); ++d) {
    sum += known[d];
    squares += known[d] * known[d];
  }
  const double mean = sum / draws;
  return {mean, std::max(0.0, squares / draws - mean * mean) / std::max(1, draws - 1)};
}

double SizeTrial::correct(int truth, std::span<const float> signal, std::span<const float> noise, float scale) const {
  return share_won(signal, noise, scale, bank_->places(), bank_->alternatives(), truth);
}

std::vector<float> SizeTrial::with_defects(const Response& response, const cv::Mat1b& defects) const {
  const int window = bank_->window_samples();
  cv::Mat1f patch(window, window);
  std::copy(response.patch.begin(), response.patch.end(), patch.begin());
  replace_dead(patch, defects, conditions_.samples_per_pitch);
  std::vector<float> scores = response.scores;
  for (std::size_t s = 0; s < response.patch.size(); ++s) {
    const float amount = patch(static_cast<int>(s) / window, static_cast<int>(s) % window) - response.patch[s];
    if (amount != 0) bank_->add_sample(s, amount, scores);
  }
  return scores;
}

}  // namespace todbench
