// SPDX-License-Identifier: GPL-3.0-or-later
#include "hvs/observer/answer_lattice.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include "acquisition/base/multiversion.h"
#include "acquisition/base/try.h"
#include "hvs/observer/eye_noise.h"
#include "hvs/observer/steffen.h"
#include "hvs/observer/template_bank.h"

namespace todbench {
namespace {

constexpr std::size_t block = TemplateBank::block;
constexpr std::size_t most_alternatives = Choice::max_alternatives;

// Nodes of the lattice, in ln sigma and ln s.
constexpr double sigma_step = 0.2, noise_step = 0.3;

/// A template takes part within this many standard deviations; the best one of each alternative always does.
constexpr float reach_sd = 5;

/// Places along the direction, in standard deviations.
constexpr std::size_t places_along = 19;
constexpr double first_along = -4.5, along_step = 0.5;

/// A score that never wins.
constexpr float never = -1e30F;

/// Lower limit of a probability, so that its logarithm is finite.
constexpr double least_probability = 1e-300;

using Tops = std::array<std::array<double, places_along>, most_alternatives>;

/// For each place along the direction: the largest signal / s + noise + place * along over some blocks of templates.
TODBENCH_MULTIVERSION
void largest_along(const float* signal, const float* noise, const float* along, std::size_t count, float scale,
                   float sign, float shift, float* tops) {
  float lanes[places_along][block];
  for (auto& lane : lanes) {
    for (std::size_t t = 0; t < block; ++t) lane[t] = never;
  }
  for (std::size_t first = 0; first < count; first += block) {
    float base[block];
    for (std::size_t t = 0; t < block; ++t)
      base[t] = signal[first + t] * scale + sign * (noise[first + t] - shift * along[first + t]);
    for (std::size_t v = 0; v < places_along; ++v) {
      const float place = static_cast<float>(first_along) + static_cast<float>(along_step) * static_cast<float>(v);
      for (std::size_t t = 0; t < block; ++t) {
        const float here = base[t] + place * along[first + t];
        lanes[v][t] = here > lanes[v][t] ? here : lanes[v][t];
      }
    }
  }
  for (std::size_t v = 0; v < places_along; ++v) {
    for (std::size_t half = block / 2; half > 0; half /= 2) {
      for (std::size_t t = 0; t < half; ++t)
        lanes[v][t] = lanes[v][t + half] > lanes[v][t] ? lanes[v][t + half] : lanes[v][t];
    }
    tops[v] = lanes[v][0];
  }
}

/// Probability of a standard normal variable between two limits, without loss of precision in the tails.
double between(double low, double high) {
  if (low > 0) return between(-high, -low);
  return 0.5 * (std::erfc(-high / std::numbers::sqrt2) - std::erfc(-low / std::numbers::sqrt2));
}

/// Adds the probability of each alternative on [from, to] to `shares`. Its score is linear, with the values of `tops`
/// at `at` and `at + along_step`.
void share_segment(const Tops& tops, std::size_t alternatives, std::size_t v, double from, double to,
                   std::array<double, most_alternatives>& shares) {
  const double at = first_along + along_step * static_cast<double>(v);
  const auto slope = [&](std::size_t o) { return (tops[o][v + 1] - tops[o][v]) / along_step; };
  double here = from;
  // The best at the left end; at an infinite end the one with the smallest slope.
  std::size_t best = 0;
  for (std::size_t o = 1; o < alternatives; ++o) {
    if (std::isfinite(from)) {
      const double mine = tops[o][v] + slope(o) * (from - at), top = tops[best][v] + slope(best) * (from - at);
      if (mine > top || (mine == top && slope(o) > slope(best))) best = o;
    } else if (slope(o) < slope(best) || (slope(o) == slope(best) && tops[o][v] > tops[best][v])) {
      best = o;
    }
  }
  while (here < to) {
    double next = to;
    std::size_t then = best;
    for (std::size_t o = 0; o < alternatives; ++o) {
      const double faster = slope(o) - slope(best);
      if (!(faster > 0)) continue;
      const double crossing = std::max(here, at + (tops[best][v] - tops[o][v]) / faster);
      if (crossing < next || (crossing == next && then != best && slope(o) > slope(then))) {
        next = crossing;
        then = o;
      }
    }
    shares[best] += between(here, next);
    if (then == best) break;
    here = next;
    best = then;
  }
}

void share_range(const Tops& tops, std::size_t alternatives, std::array<double, most_alternatives>& shares) {
  constexpr double infinite = std::numeric_limits<double>::infinity();
  for (std::size_t v = 0; v + 1 < places_along; ++v) {
    const double at = first_along + along_step * static_cast<double>(v);
    share_segment(tops, alternatives, v, v == 0 ? -infinite : at, v + 2 == places_along ? infinite : at + along_step,
                  shares);
  }
}

/// The centre of a patch, without its mean, in units of the contrast.
std::vector<float> scaled(const AnsweredPatch& patch, int window) {
  const int margin = (patch.kelvin.rows - window) / 2;
  const cv::Mat1f middle = patch.kelvin(cv::Rect(margin, margin, window, window));
  const double background = middle(0, 0);
  double mean = 0;
  for (const float value : middle) mean += static_cast<double>(value) - background;
  mean = background + mean / static_cast<double>(middle.total());
  std::vector<float> out;
  out.reserve(middle.total());
  for (const float value : middle)
    out.push_back(static_cast<float>((static_cast<double>(value) - mean) / patch.contrast_k));
  return out;
}

/// The same for an observer with an eye, whose background is that of the outermost samples.
std::vector<float> scaled_for_eye(const TemplateObserverSpec& spec, const AnsweredPatch& patch, int window) {
  const int margin = (patch.kelvin.rows - window) / 2;
  const Patch middle{.kelvin = cv::Mat1d(patch.kelvin(cv::Rect(margin, margin, window, window))), .phase = {}};
  std::vector<float> out(middle.kelvin.total()), room(out.size());
  seen_patch(spec, middle, patch.contrast_k, RandomStream(0, "none"), out, room);  // no noise_k: no noise
  return out;
}

int node_count(double low, double high, double step) {
  return static_cast<int>(std::ceil(std::log(high / low) / step - 1e-9)) + 1;
}

/// Position between nodes.
struct Between {
  int node = 0;      ///< at or below
  double share = 0;  ///< fraction of the distance to the next node, in [0, 1]
};
Between between_nodes(double value, double low, double step, int count) {
  const double at = std::clamp(std::log(value / low) / step, 0.0, static_cast<double>(count - 1));
  const int node = std::min(static_cast<int>(at), count - 2);
  return {node, at - node};
}

}  // namespace

struct AnswerLattice::Content {
  using Values = std::array<float, most_alternatives>;
  /// Patches of one size.
  struct Group {
    double size_samples = 0;
    int samples_per_pitch = 1;
    std::vector<std::size_t> members;
  };
  /// Scores of one patch at one sigma; alternatives in rows of whole blocks.
  struct Scores {
    std::vector<float> signal, along, likeness;  ///< likeness: product with the best template
    std::size_t first = 0, second = 0;           ///< the two best templates of different alternatives
    double distance = 1;                         ///< between these templates
    std::vector<std::optional<Values>> values;   ///< by node of s
  };
  /// Noise of one size at one sigma.
  struct Noise {
    std::vector<std::vector<float>> draws;
  };

  TemplateObserverSpec spec;
  Alternatives alternatives;
  std::vector<AnsweredPatch> patches;
  Options options;
  std::vector<Group> groups;
  std::vector<std::size_t> group_of;
  int sigmas = node_count(least_sigma, most_sigma, sigma_step);
  int noises = node_count(least_noise, most_noise, noise_step);
  /// Of each group; only with an eye, whose templates do not depend on a coordinate.
  std::vector<std::shared_ptr<const TemplateBank>> banks;
  /// [sigma][group], [sigma][patch]; with an eye [ratio of the noises] instead of [sigma]
  std::vector<std::vector<Noise>> noise;
  std::vector<std::vector<Scores>> scores;
  std::size_t row = 0;

  [[nodiscard]] Result<TemplateBank> bank(const Group& group, double sigma) const {
    TemplateObserverSpec own = spec;
    own.blur_sigma_samples = sigma;
    return TemplateBank::build(own, alternatives, group.size_samples, group.samples_per_pitch);
  }

  [[nodiscard]] std::vector<float> in_rows(const TemplateBank& bank, std::span<const float> scores_of_bank,
                                           float padding) const {
    const auto places = static_cast<std::size_t>(bank.places());
    std::vector<float> rows(row * alternatives.size(), padding);
    for (std::size_t o = 0; o < alternatives.size(); ++o)
      std::copy_n(scores_of_bank.begin() + static_cast<std::ptrdiff_t>(o * places), places,
                  rows.begin() + static_cast<std::ptrdiff_t>(o * row));
    return rows;
  }

  [[nodiscard]] std::size_t best_of(const Scores& at, std::size_t o) const {
    const auto first = at.signal.begin() + static_cast<std::ptrdiff_t>(o * row);
    return o * row +
           static_cast<std::size_t>(std::max_element(first, first + static_cast<std::ptrdiff_t>(row)) - first);
  }

  /// Probability that an alternative's best template has a larger score than the best of all.
  [[nodiscard]] double beats_best(const Scores& at, std::size_t o, double sd) const {
    const std::size_t best = best_of(at, o);
    if (best == at.first) return 1;
    const double behind = static_cast<double>(at.signal[at.first] - at.signal[best]);
    const double apart = std::sqrt(2 * std::max(0.0, 1 - static_cast<double>(at.likeness[best])));
    return apart > 0 ? between(behind / (sd * apart), std::numeric_limits<double>::infinity()) : 0.5;
  }

  void find_best(Scores& at) const {
    std::vector<std::size_t> best(alternatives.size());
    for (std::size_t o = 0; o < alternatives.size(); ++o) best[o] = best_of(at, o);
    std::sort(best.begin(), best.end(), [&](std::size_t a, std::size_t b) { return at.signal[a] > at.signal[b]; });
    at.first = best[0];
    at.second = best[1];
  }

  [[nodiscard]] std::size_t in_bank(std::size_t index, const TemplateBank& bank) const {
    return index / row * static_cast<std::size_t>(bank.places()) + index % row;
  }

  /// The shares of both noises of an observer with an eye at one node of their ratio.
  struct Mixture {
    float eye = 0, white = 0;
    explicit Mixture(double ratio)
        : eye(static_cast<float>(ratio / std::hypot(1, ratio))), white(static_cast<float>(1 / std::hypot(1, ratio))) {}
  };

  /// Covariances of the scores of one template with those of all, in the order of the bank.
  [[nodiscard]] static std::vector<float> covariances(const TemplateBank& bank, std::size_t index,
                                                      const Mixture& mixture) {
    const auto side = static_cast<std::size_t>(bank.window_samples());
    std::vector<float> samples(side * side), products(bank.padded_templates()), numbers;
    bank.copy_template(index, samples);
    bank.project(samples, products);
    for (float& product : products) product *= mixture.white * mixture.white;
    for (const auto& column : bank.eye()->columns()) numbers.push_back(static_cast<float>(column[index]));
    bank.eye()->add(numbers, mixture.eye * mixture.eye, products);
    return products;
  }

  void prepare_eye(std::size_t ratio, std::size_t g) {
    const Group& group = groups[g];
    const TemplateBank& bank_of_group = *banks[g];
    const EyeNoise& eye = *bank_of_group.eye();
    const Mixture mixture(std::exp(noise_step * (static_cast<double>(ratio) - (noises - 1))));
    const auto side = static_cast<std::size_t>(bank_of_group.window_samples());
    std::vector<float> samples(side * side), products(bank_of_group.padded_templates()), numbers(eye.rank());
    const RandomStream stream = RandomStream(options.seed, "observer.fit").sub(side);
    Noise& own = noise[ratio][g];
    for (int k = 0; k < options.draws / 2; ++k) {
      const RandomStream draw = stream.sub(static_cast<std::uint64_t>(k));
      draw.fill_normal(samples);
      draw.sub(1).fill_normal(numbers);
      bank_of_group.project(samples, products);
      for (float& product : products) product *= mixture.white;
      eye.add(numbers, mixture.eye, products);
      own.draws.push_back(in_rows(bank_of_group, products, 0));
    }
    std::vector<float> variances(static_cast<std::size_t>(bank_of_group.templates()));
    for (std::size_t t = 0; t < variances.size(); ++t)
      variances[t] =
          mixture.eye * mixture.eye + mixture.white * mixture.white * static_cast<float>(bank_of_group.square(t));
    for (const std::size_t i : group.members) {
      Scores& at = scores[ratio][i];
      bank_of_group.project(scaled_for_eye(spec, patches[i], bank_of_group.window_samples()), products);
      at.signal = in_rows(bank_of_group, products, never);
      at.values.assign(static_cast<std::size_t>(noises), std::nullopt);
      find_best(at);
      const std::size_t first = in_bank(at.first, bank_of_group), second = in_bank(at.second, bank_of_group);
      std::vector<float> of_first = covariances(bank_of_group, first, mixture);
      const std::vector<float> of_second = covariances(bank_of_group, second, mixture);
      const float square = of_first[first] + of_second[second] - 2 * of_first[second];
      at.distance = std::sqrt(std::max(0.0, static_cast<double>(square)));
      std::vector<float> along(of_first.size(), 0.0F);
      for (std::size_t t = 0; t < along.size() && at.distance > 0; ++t)
        along[t] = static_cast<float>(static_cast<double>(of_first[t] - of_second[t]) / at.distance);
      at.along = in_rows(bank_of_group, along, 0);
      for (std::size_t t = 0; t < variances.size(); ++t)
        of_first[t] = 1 - (variances[first] + variances[t] - 2 * of_first[t]) / 2;
      at.likeness = in_rows(bank_of_group, of_first, 0);
    }
  }

  void prepare(std::size_t sigma, std::size_t g) {
    if (spec.eye) {
      prepare_eye(sigma, g);
      return;
    }
    const Group& group = groups[g];
    // create() has built this bank with the same parameters except the blur, on which no limit depends.
    const Result<TemplateBank> built = bank(group, least_sigma * std::exp(sigma_step * static_cast<double>(sigma)));
    CV_Assert(built);
    const auto side = static_cast<std::size_t>(built->window_samples());
    std::vector<float> samples(side * side), products(built->padded_templates());
    const RandomStream stream = RandomStream(options.seed, "observer.fit").sub(side);
    Noise& own = noise[sigma][g];
    for (int k = 0; k < options.draws / 2; ++k) {
      stream.sub(static_cast<std::uint64_t>(k)).fill_normal(samples);
      built->project(samples, products);
      own.draws.push_back(in_rows(*built, products, 0));
    }
    std::vector<float> other(side * side);
    for (const std::size_t i : group.members) {
      Scores& at = scores[sigma][i];
      built->project(scaled(patches[i], built->window_samples()), products);
      at.signal = in_rows(*built, products, never);
      at.values.assign(static_cast<std::size_t>(noises), std::nullopt);
      find_best(at);
      built->copy_template(in_bank(at.first, *built), samples);
      built->project(samples, products);
      at.likeness = in_rows(*built, products, 0);
      built->copy_template(in_bank(at.second, *built), other);
      double square = 0;
      for (std::size_t s = 0; s < samples.size(); ++s) {
        samples[s] -= other[s];
        square += static_cast<double>(samples[s]) * static_cast<double>(samples[s]);
      }
      at.distance = std::sqrt(square);
      for (float& value : samples)
        value = square > 0 ? static_cast<float>(static_cast<double>(value) / at.distance) : 0;
      built->project(samples, products);
      at.along = in_rows(*built, products, 0);
    }
  }

  /// The templates of each alternative that can win: score_best - score < reach sd sqrt(2 (1 - likeness)).
  [[nodiscard]] std::vector<std::vector<std::size_t>> contenders(const Scores& at, double sd) const {
    std::vector<std::vector<std::size_t>> out(alternatives.size());
    const float limit = 2 * reach_sd * reach_sd * static_cast<float>(sd * sd);
    for (std::size_t o = 0; o < alternatives.size(); ++o) {
      const std::size_t best = best_of(at, o);
      for (std::size_t t = o * row; t < (o + 1) * row; ++t) {
        const float behind = at.signal[at.first] - at.signal[t];
        const bool real = at.signal[t] > never;
        if (t == best || (real && behind * behind <= limit * (1 - at.likeness[t]))) out[o].push_back(t);
      }
    }
    return out;
  }

  [[nodiscard]] Values computed(const Scores& at, const Noise& own, double sd) const {
    std::array<double, most_alternatives> sum{};
    Tops tops{};
    const auto scale = static_cast<float>(1 / sd);
    // The templates that take part, by alternative, in whole blocks.
    const auto able = contenders(at, sd);
    std::vector<std::size_t> begin(alternatives.size() + 1, 0);
    for (std::size_t o = 0; o < alternatives.size(); ++o)
      begin[o + 1] = begin[o] + (able[o].size() + block - 1) / block * block;
    std::vector<float> signal(begin.back(), never), along_of(begin.back(), 0), drawn(begin.back(), 0);
    for (std::size_t o = 0; o < alternatives.size(); ++o) {
      for (std::size_t i = 0; i < able[o].size(); ++i) {
        signal[begin[o] + i] = at.signal[able[o][i]];
        along_of[begin[o] + i] = at.along[able[o][i]];
      }
    }
    for (const auto& draw : own.draws) {
      for (std::size_t o = 0; o < alternatives.size(); ++o) {
        for (std::size_t i = 0; i < able[o].size(); ++i) drawn[begin[o] + i] = draw[able[o][i]];
      }
      const double along = at.distance > 0 ? static_cast<double>(draw[at.first] - draw[at.second]) / at.distance : 0;
      for (const float sign : {1.0F, -1.0F}) {
        for (std::size_t o = 0; o < alternatives.size(); ++o) {
          float largest[places_along];
          largest_along(&signal[begin[o]], &drawn[begin[o]], &along_of[begin[o]], begin[o + 1] - begin[o], scale, sign,
                        static_cast<float>(along), largest);
          std::copy(std::begin(largest), std::end(largest), tops[o].begin());
        }
        share_range(tops, alternatives.size(), sum);
      }
    }
    Values out{};
    const double draws = 2.0 * static_cast<double>(own.draws.size());
    for (std::size_t o = 0; o < alternatives.size(); ++o) {
      // Resolution of the draws: half a draw, weighted with the probability that the best template wins.
      const double share = (sum[o] + 0.5 * beats_best(at, o, sd)) / draws;
      out[o] = static_cast<float>(std::log(std::max(share, least_probability)));
    }
    return out;
  }

  const Values& value(std::size_t patch, int sigma, int sd) {
    const auto a = static_cast<std::size_t>(std::clamp(sigma, 0, sigmas - 1));
    const auto j = static_cast<std::size_t>(std::clamp(sd, 0, noises - 1));
    // Noises of the eye and white ones with one difference of nodes have one ratio.
    const std::size_t slot = spec.eye ? a + static_cast<std::size_t>(noises - 1) - j : a;
    const double white = least_noise * std::exp(noise_step * static_cast<double>(j));
    Scores& at = scores[slot][patch];
    if (at.values.empty()) prepare(slot, group_of[patch]);
    if (!at.values[j]) {
      const double eye = least_noise * std::exp(noise_step * static_cast<double>(a));
      at.values[j] = computed(at, noise[slot][group_of[patch]], spec.eye ? std::hypot(eye, white) : white);
    }
    return *at.values[j];
  }
};

AnswerLattice::AnswerLattice(std::unique_ptr<Content> content) : content_(std::move(content)) {}
AnswerLattice::AnswerLattice(AnswerLattice&&) noexcept = default;
AnswerLattice& AnswerLattice::operator=(AnswerLattice&&) noexcept = default;
AnswerLattice::~AnswerLattice() = default;

Result<AnswerLattice> AnswerLattice::create(const TemplateObserverSpec& spec, const Alternatives& alternatives,
                                            std::vector<AnsweredPatch> patches, const Options& options) {
  CV_Assert(options.draws >= 2 && options.draws % 2 == 0);
  CV_Assert(alternatives.size() >= 2 && alternatives.size() <= most_alternatives);
  TODBENCH_TRY_VOID(validate(spec));
  auto content = std::make_unique<Content>();
  content->spec = spec;
  content->alternatives = alternatives;
  content->options = options;
  std::map<std::pair<double, int>, std::size_t> known;
  for (std::size_t i = 0; i < patches.size(); ++i) {
    const AnsweredPatch& patch = patches[i];
    const auto refuse = [&](const std::string& why) {
      return fail(ErrorCode::invalid_input, "patch " + std::to_string(i + 1) + ": " + why);
    };
    if (patch.kelvin.rows != patch.kelvin.cols || patch.kelvin.rows % 2 != 0)
      return refuse("expected a square with an even number of samples on a side");
    if (!cv::checkRange(patch.kelvin)) return refuse("a sample is not finite");
    if (!std::isfinite(patch.contrast_k) || patch.contrast_k == 0) return refuse("a contrast of 0 cannot be judged");
    if (!(patch.noise_k >= 0) || !std::isfinite(patch.noise_k)) return refuse("the noise must be at least 0");
    const auto [place, added] =
        known.try_emplace({patch.size_samples, patch.samples_per_pitch}, content->groups.size());
    if (added) content->groups.push_back({patch.size_samples, patch.samples_per_pitch, {}});
    Content::Group& group = content->groups[place->second];
    group.members.push_back(i);
    content->group_of.push_back(place->second);
    const int window = added ? 0 : patches[group.members.front()].kelvin.rows;
    if (!added && window == patch.kelvin.rows) continue;
    const Result<TemplateBank> bank = content->bank(group, spec.blur_sigma_samples);
    if (!bank) return refuse(bank.error().message);
    if (patch.kelvin.rows < bank->window_samples()) {
      return refuse("it has " + std::to_string(patch.kelvin.rows) + " samples on a side, but observer " + spec.name +
                    " needs at least " + std::to_string(bank->window_samples()));
    }
    content->row = (static_cast<std::size_t>(bank->places()) + block - 1) / block * block;
    if (spec.eye && added) content->banks.push_back(std::make_shared<const TemplateBank>(*bank));
  }
  content->patches = std::move(patches);
  if (spec.eye) content->sigmas = content->noises;
  const auto slots = static_cast<std::size_t>(spec.eye ? 2 * content->noises - 1 : content->sigmas);
  content->noise.assign(slots, std::vector<Content::Noise>(content->groups.size()));
  content->scores.assign(slots, std::vector<Content::Scores>(content->patches.size()));
  return AnswerLattice(std::move(content));
}

std::size_t AnswerLattice::patches() const {
  return content_->patches.size();
}
int AnswerLattice::alternatives() const {
  return static_cast<int>(content_->alternatives.size());
}
const AnsweredPatch& AnswerLattice::patch(std::size_t index) const {
  return content_->patches[index];
}

bool AnswerLattice::has_eye() const {
  return content_->spec.eye.has_value();
}

double AnswerLattice::eye_noise(std::size_t patch, double gain, double contrast_noise) const {
  const auto& bank = content_->banks[content_->group_of[patch]];
  return bank->eye()->sd(content_->patches[patch].contrast_k, gain, contrast_noise);
}

AnswerLogProbabilities AnswerLattice::log_probabilities(std::size_t patch, double first, double noise) {
  CV_Assert(patch < patches() && first > 0 && noise > 0);
  const Between sigma = has_eye() ? between_nodes(first, least_noise, noise_step, content_->sigmas)
                                  : between_nodes(first, least_sigma, sigma_step, content_->sigmas);
  const Between sd = between_nodes(noise, least_noise, noise_step, content_->noises);
  std::array<std::array<const Content::Values*, 4>, 4> nodes{};
  for (int a = 0; a < 4; ++a) {
    for (int j = 0; j < 4; ++j)
      nodes[static_cast<std::size_t>(a)][static_cast<std::size_t>(j)] =
          &content_->value(patch, sigma.node + a - 1, sd.node + j - 1);
  }
  AnswerLogProbabilities out;
  double sum = 0;
  const auto count = static_cast<std::size_t>(alternatives());
  for (std::size_t o = 0; o < count; ++o) {
    std::array<double, 4> along{};
    for (std::size_t a = 0; a < 4; ++a) {
      std::array<double, 4> y{};
      for (std::size_t j = 0; j < 4; ++j) y[j] = static_cast<double>((*nodes[a][j])[o]);
      along[a] = steffen(y, sd.share);
    }
    out.value[o] = steffen(along, sigma.share);
    sum += std::exp(out.value[o]);
  }
  for (std::size_t o = 0; o < count; ++o) out.value[o] -= std::log(sum);
  return out;
}

}  // namespace todbench
