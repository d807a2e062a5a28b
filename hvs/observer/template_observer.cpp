// SPDX-License-Identifier: GPL-3.0-or-later
#include "hvs/observer/template_observer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <mutex>
#include <optional>
#include <vector>

#include "acquisition/base/try.h"
#include "hvs/observer/answer_probabilities.h"
#include "hvs/observer/eye_noise.h"

namespace todbench {
namespace {

// Windows up to this many samples and banks up to this many templates are judged without heap memory.
constexpr std::size_t stack_samples = 64 * 64;
constexpr std::size_t stack_templates = 4096;

// Positions in a trial's random stream: pixel noise first, the tie-break far behind it.
constexpr std::uint64_t tie_break_index = std::uint64_t{1} << 40;
// Substream of a trial for the noise of the eye.
constexpr std::uint64_t eye_sub_stream = 2;
// Substream of a trial for the draws of graded answers, separate from the single answer.
constexpr std::uint64_t graded_sub_stream = 1;

/// Internal noise and the enlargement of the sensor's noise by this observer, combined: sd per sample in units of the
/// contrast.
double own_noise(const TemplateObserverSpec& spec, const Patch& patch, double contrast_k) {
  const double enlarged = spec.sensor_noise_factor * spec.sensor_noise_factor - 1;
  const double seen = patch.noise_k / contrast_k;
  return std::sqrt(spec.internal_noise * spec.internal_noise + enlarged * seen * seen);
}

/// The patch without its mean, in units of the contrast. Differences are formed in double precision, so that a
/// background of 300 K causes no error.
void scale_to_contrast(const Patch& patch, double contrast_k, std::span<float> signal) {
  const double background = patch.kelvin(0, 0);
  double mean = 0;
  for (const double value : patch.kelvin) mean += value - background;
  mean = background + mean / static_cast<double>(signal.size());
  std::size_t s = 0;
  for (const double value : patch.kelvin) signal[s++] = static_cast<float>((value - mean) / contrast_k);
}

/// The patch without the mean of its outermost samples, in units of the contrast.
void scale_to_background(const Patch& patch, double contrast_k, std::span<float> signal) {
  const cv::Mat1d& kelvin = patch.kelvin;
  const double background = kelvin(0, 0);
  double sum = 0;
  int count = 0;
  const auto add = [&](double value) {
    sum += value - background;
    ++count;
  };
  for (int column = 0; column < kelvin.cols; ++column) {
    add(kelvin(0, column));
    add(kelvin(kelvin.rows - 1, column));
  }
  for (int row = 1; row + 1 < kelvin.rows; ++row) {
    add(kelvin(row, 0));
    add(kelvin(row, kelvin.cols - 1));
  }
  const double surround = background + sum / count;
  std::size_t s = 0;
  for (const double value : kelvin) signal[s++] = static_cast<float>((value - surround) / contrast_k);
}

/// Adds white noise of standard deviation `sd` to the samples. `room` has as many numbers as samples.
void add_own_noise(double sd, const RandomStream& noise, std::span<float> samples, std::span<float> room) {
  if (!(sd > 0)) return;
  noise.fill_normal(room);
  for (std::size_t s = 0; s < samples.size(); ++s) samples[s] += static_cast<float>(sd) * room[s];
}

void scale_patch(const TemplateObserverSpec& spec, const Patch& patch, double contrast_k, std::span<float> signal) {
  if (spec.eye) {
    scale_to_background(patch, contrast_k, signal);
  } else {
    scale_to_contrast(patch, contrast_k, signal);
  }
}

class PreparedTemplateObserver final : public PreparedObserver {
 public:
  PreparedTemplateObserver(TemplateObserverSpec spec, std::shared_ptr<const TemplateBank> bank)
      : spec_(std::move(spec)), bank_(std::move(bank)) {}

  [[nodiscard]] int window_samples() const override { return bank_->window_samples(); }
  [[nodiscard]] double search_samples() const override { return spec_.search_range_samples; }

  [[nodiscard]] Choice choose(const Patch& patch, double contrast_k, const RandomStream& noise) const override {
    const std::size_t samples = samples_of(patch);
    if (samples <= stack_samples && bank_->padded_templates() <= stack_templates) {
      std::array<float, stack_samples> signal, draws;
      std::array<float, stack_templates> scores;
      return decide(patch, contrast_k, noise, std::span(signal).first(samples), std::span(draws).first(samples),
                    std::span(scores).first(bank_->padded_templates()));
    }
    std::vector<float> signal(samples), draws(samples), scores(bank_->padded_templates());
    return decide(patch, contrast_k, noise, signal, draws, scores);
  }

  [[nodiscard]] GradedChoice judge(const Patch& patch, double contrast_k, const RandomStream& noise,
                                   int draws) const override {
    const ScoreNoise& own = own_noise_of_scores();
    const std::size_t samples = samples_of(patch), templates = bank_->padded_templates();
    if (samples <= stack_samples && templates <= stack_templates && own.size() <= stack_templates &&
        own.rank() <= stack_samples) {
      std::array<float, stack_samples> signal, seen, direction;
      std::array<float, (products_at_once + 1) * stack_samples> numbers;
      std::array<float, stack_templates> scores, seen_scores, rows, along;
      return grade(patch, contrast_k, noise, draws,
                   {.signal = std::span(signal).first(samples),
                    .seen = std::span(seen).first(samples),
                    .noise = std::span(numbers).first(samples),
                    .scores = std::span(scores).first(templates),
                    .seen_scores = std::span(seen_scores).first(templates)},
                   {.rows = std::span(rows).first(own.size()),
                    .along = std::span(along).first(own.size()),
                    .numbers = std::span(numbers).first((products_at_once + 1) * own.rank()),
                    .direction = std::span(direction).first(own.rank())});
    }
    std::vector<float> signal(samples), seen(samples), pixel_noise(samples), scores(templates), seen_scores(templates);
    std::vector<float> rows(own.size()), along(own.size()), numbers((products_at_once + 1) * own.rank()),
        direction(own.rank());
    return grade(patch, contrast_k, noise, draws,
                 {.signal = signal, .seen = seen, .noise = pixel_noise, .scores = scores, .seen_scores = seen_scores},
                 {.rows = rows, .along = along, .numbers = numbers, .direction = direction});
  }

 private:
  /// Memory of judge(): the patch without and with the observer's own noise, and the scores of both.
  struct TwoPatches {
    std::span<float> signal, seen, noise, scores, seen_scores;
  };

  [[nodiscard]] std::size_t samples_of(const Patch& patch) const {
    CV_Assert(patch.kelvin.rows == bank_->window_samples() && patch.kelvin.cols == bank_->window_samples());
    return patch.kelvin.total();
  }

  [[nodiscard]] Choice decide(const Patch& patch, double contrast_k, const RandomStream& noise, std::span<float> signal,
                              std::span<float> draws, std::span<float> scores) const {
    seen_patch(spec_, patch, contrast_k, noise, signal, draws);
    bank_->project(signal, scores);
    return choice_of(scores, contrast_k, noise);
  }

  /// The answer to a patch by its scores. Adds the noise of the eye to the scores.
  [[nodiscard]] Choice choice_of(std::span<float> scores, double contrast_k, const RandomStream& noise) const {
    if (const EyeNoise* eye = bank_->eye(); eye != nullptr) {
      std::array<float, stack_templates> numbers;
      std::vector<float> many(eye->rank() > numbers.size() ? eye->rank() : 0);
      const auto own = many.empty() ? std::span<float>(numbers).first(eye->rank()) : std::span<float>(many);
      noise.sub(eye_sub_stream).fill_normal(own);
      eye->add(own, static_cast<float>(eye->sd(contrast_k)), scores);
    }
    Choice choice;
    choice.alternatives = bank_->alternatives();
    const auto places = static_cast<std::size_t>(bank_->places());
    for (int o = 0; o < choice.alternatives; ++o) {
      const auto mine = scores.subspan(static_cast<std::size_t>(o) * places, places);
      choice.scores[static_cast<std::size_t>(o)] = static_cast<double>(*std::max_element(mine.begin(), mine.end()));
    }
    choice.alternative = winning_alternative(choice, noise);
    return choice;
  }

  /// Both patches are projected together: the templates, which fill a cache, are read once.
  [[nodiscard]] GradedChoice grade(const Patch& patch, double contrast_k, const RandomStream& noise, int draws,
                                   const TwoPatches& room, const AnswerRoom& answers) const {
    scale_patch(spec_, patch, contrast_k, room.signal);
    std::copy(room.signal.begin(), room.signal.end(), room.seen.begin());
    const double white = own_noise(spec_, patch, contrast_k);
    add_own_noise(white, noise, room.seen, room.noise);
    bank_->project_all(std::array<std::span<const float>, 2>{room.signal, room.seen},
                       std::array<std::span<float>, 2>{room.scores, room.seen_scores});
    const Choice choice = choice_of(room.seen_scores, contrast_k, noise);
    const ScoreNoiseLevels levels{.white = white, .eye = bank_->eye() != nullptr ? bank_->eye()->sd(contrast_k) : 0};
    return {choice, answer_probabilities(own_noise_of_scores(), room.scores, levels, noise.sub(graded_sub_stream),
                                         draws, answers)};
  }

  /// Created at the first graded answer: it costs as much as the bank, and most observers only choose.
  [[nodiscard]] const ScoreNoise& own_noise_of_scores() const {
    const bool white = !spec_.eye || spec_.sensor_noise_factor > 1;
    std::call_once(noise_made_, [&] { noise_.emplace(*bank_, white ? AddedWhiteNoise::yes : AddedWhiteNoise::no); });
    return *noise_;
  }

  TemplateObserverSpec spec_;
  std::shared_ptr<const TemplateBank> bank_;
  mutable std::once_flag noise_made_;
  mutable std::optional<ScoreNoise> noise_;
};

}  // namespace

void seen_patch(const TemplateObserverSpec& spec, const Patch& patch, double contrast_k, const RandomStream& noise,
                std::span<float> seen, std::span<float> room) {
  scale_patch(spec, patch, contrast_k, seen);
  add_own_noise(own_noise(spec, patch, contrast_k), noise, seen, room);
}

int winning_alternative(const Choice& choice, const RandomStream& noise) {
  const auto end = choice.scores.begin() + choice.alternatives;
  const double best = *std::max_element(choice.scores.begin(), end);
  const auto ties = static_cast<std::uint64_t>(std::count(choice.scores.begin(), end, best));
  auto pick = ties > 1 ? noise.below(ties, tie_break_index) : 0;
  for (int o = 0; o < choice.alternatives; ++o) {
    if (choice.scores[static_cast<std::size_t>(o)] == best && pick-- == 0) return o;
  }
  return 0;  // unreachable: some score equals the maximum
}

Result<void> validate(const TemplateObserverSpec& spec) {
  const auto refuse = [](const std::string& what) { return fail(ErrorCode::invalid_input, what); };
  if (spec.name.empty()) return refuse("an observer needs a name");
  if (!(spec.blur_sigma_samples >= 0.1 && spec.blur_sigma_samples <= 10))
    return refuse("blur_sigma_samples must be from 0.1 to 10");
  if (!(spec.internal_noise >= 0 && spec.internal_noise <= 10)) return refuse("internal_noise must be from 0 to 10");
  if (!(spec.sensor_noise_factor >= 1 && spec.sensor_noise_factor <= 100))
    return refuse("sensor_noise_factor must be from 1 to 100");
  const double steps = spec.search_step_samples > 0 ? 1 / spec.search_step_samples : 0;
  if (!(steps >= 1 && steps <= 64 && std::abs(steps - std::round(steps)) < 1e-9)) {
    return refuse("search_step_samples must be 1/n with a whole number n from 1 to 64");
  }
  const double reach = spec.search_range_samples * steps;
  if (!(reach >= 0 && reach <= 128 && std::abs(reach - std::round(reach)) < 1e-9)) {
    return refuse("search_range_samples must be a whole number of search steps, at most 128");
  }
  if (!(spec.window_size_factor >= 0.9 && spec.window_size_factor <= 10))
    return refuse("window_size_factor must be from 0.9 to 10");
  if (!(spec.window_margin_pitch >= 0 && spec.window_margin_pitch <= 100))
    return refuse("window_margin_pitch must be from 0 to 100");
  if (!(spec.sample_aspect >= 0.5 && spec.sample_aspect <= 2)) return refuse("sample_aspect must be from 0.5 to 2");
  if (!spec.eye) {
    if (spec.display) return refuse("only an observer with an eye has a display");
    return {};
  }
  TODBENCH_TRY_VOID(validate(*spec.eye));
  if (spec.internal_noise != 0) return refuse("an observer with an eye has no internal_noise of its own");
  if (!(spec.window_margin_arcmin >= 0 && spec.window_margin_arcmin <= 120))
    return refuse("window_margin_arcmin must be from 0 to 120");
  if (spec.display) return validate(*spec.display);
  return {};
}

TemplateObserver::TemplateObserver(TemplateObserverSpec spec, Alternatives alternatives)
    : spec_(std::move(spec)), alternatives_(std::move(alternatives)) {
  CV_Assert(alternatives_.size() >= 2 && alternatives_.size() <= Choice::max_alternatives);
}

Result<std::shared_ptr<const TemplateBank>> TemplateObserver::bank(double size_samples, int samples_per_pitch) {
  const std::scoped_lock lock(mutex_);
  auto& slot = banks_[{size_samples, samples_per_pitch}];
  if (slot == nullptr) {
    auto built = TemplateBank::build(spec_, alternatives_, size_samples, samples_per_pitch);
    if (!built) {
      banks_.erase({size_samples, samples_per_pitch});
      return fail("observer " + spec_.name, built.error());
    }
    slot = std::make_shared<const TemplateBank>(std::move(*built));
  }
  return slot;
}

Result<std::shared_ptr<const PreparedObserver>> TemplateObserver::prepare(double size_samples, int samples_per_pitch) {
  TODBENCH_TRY(auto found, bank(size_samples, samples_per_pitch));
  const std::scoped_lock lock(mutex_);
  auto& slot = prepared_[{size_samples, samples_per_pitch}];
  if (slot == nullptr) slot = std::make_shared<const PreparedTemplateObserver>(spec_, found);
  return slot;
}

}  // namespace todbench
