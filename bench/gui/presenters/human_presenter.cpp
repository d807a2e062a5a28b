// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/presenters/human_presenter.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "acquisition/base/rng.h"
#include "bench/gui/presenters/colour_map.h"
#include "bench/session/open_session.h"
#include "bench/session/provenance.h"
#include "hvs/eye/display_levels.h"

namespace todbench {
namespace {

/// Fisher-Yates shuffle with reproducible random numbers.
void shuffle(std::vector<std::size_t>& items, const RandomStream& stream) {
  for (std::size_t i = items.size(); i > 1; --i) std::swap(items[i - 1], items[stream.below(i, i)]);
}

double median(cv::Mat1f values) {
  std::vector<float> sorted(values.begin(), values.end());
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  return *middle;
}

}  // namespace

std::vector<JudgedTrial> patches_for_a_person(const std::vector<JudgedTrial>& trials, const HumanOptions& options) {
  const RandomStream stream(options.seed, "human");
  // Sizes of one row of the plate differ in the last bits of the description; micrometres identify them.
  std::map<std::pair<double, std::int64_t>, std::vector<std::size_t>> groups;
  for (std::size_t i = 0; i < trials.size(); ++i)
    groups[{trials[i].trial.set_delta_t_k, std::llround(trials[i].trial.size_mm * 1000)}].push_back(i);
  std::vector<std::size_t> chosen;
  std::uint64_t number = 0;
  for (auto& [key, members] : groups) {
    shuffle(members, stream.sub(++number));
    const auto count = std::min(members.size(), static_cast<std::size_t>(std::max(options.per_size, 0)));
    chosen.insert(chosen.end(), members.begin(), members.begin() + static_cast<std::ptrdiff_t>(count));
  }
  shuffle(chosen, stream.sub(0));
  std::vector<JudgedTrial> out;
  out.reserve(chosen.size());
  for (const std::size_t i : chosen) out.push_back(trials[i]);
  return out;
}

std::vector<JudgedTrial> patches_for_training(const std::vector<JudgedTrial>& trials, const HumanOptions& options) {
  std::vector<std::size_t> order(trials.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  shuffle(order, RandomStream(options.seed, "human training"));
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    const Trial &one = trials[a].trial, &other = trials[b].trial;
    return std::pair(-std::abs(one.set_delta_t_k), -std::round(one.size_mm * 1000)) <
           std::pair(-std::abs(other.set_delta_t_k), -std::round(other.size_mm * 1000));
  });
  const auto count = std::min(order.size(), static_cast<std::size_t>(std::max(options.training, 0)));
  std::vector<JudgedTrial> out;
  for (std::size_t i = 0; i < count; ++i) out.push_back(trials[order[i]]);
  return out;
}

LevelSpan grey_levels(const JudgedTrial& judged) {
  const double surround = median(judged.patch_k);
  cv::Scalar mean, sd;
  cv::meanStdDev(judged.patch_k, mean, sd);
  const double half = 1.5 * std::max(std::abs(judged.trial.delta_t_k), sd[0]);
  return {surround - half, surround + half};
}

QImage picture_for_a_person(const JudgedTrial& judged, int magnification) {
  cv::Mat1d fine;
  cv::resize(cv::Mat1d(judged.patch_k), fine, {}, magnification, magnification, cv::INTER_CUBIC);
  return to_image(fine, grey_levels(judged), ColourMap::white_hot);
}

LevelSpan grey_levels(const JudgedTrial& judged, const ViewedDisplay& display) {
  const double surround = median(judged.patch_k);
  const LevelContrasts contrasts = level_contrasts(display);
  if (display.span_k > 0) {
    const BetweenLevels background = between_levels(contrasts, 0);
    const double below_k = display.span_k * (background.below + background.share) / 255;
    return {surround - below_k, surround - below_k + display.span_k};
  }
  const double k_per_contrast = std::abs(judged.trial.delta_t_k) / display.contrast;
  return {surround + contrasts.front() * k_per_contrast, surround + contrasts.back() * k_per_contrast};
}

QImage picture_at_display(const JudgedTrial& judged, const ViewedDisplay& display) {
  return grey_image(
      operator_picture(display, cv::Mat1d(judged.patch_k) - median(judged.patch_k), judged.trial.delta_t_k));
}

int HumanPresenter::background_level() const {
  return at_display() ? background_level_of(plan_.display) : 128;
}

HumanPresenter::HumanPresenter(QObject* parent) : QObject(parent) {
  hide_.setSingleShot(true);
  connect(&hide_, &QTimer::timeout, this, [this] {
    if (state_ != HumanState::showing) return;
    state_ = HumanState::hidden;
    emit updated();
  });
}

QString HumanPresenter::begin(const std::vector<JudgedTrial>& trials, const Plan& plan,
                              const std::filesystem::path& session, const HumanOptions& options) {
  if (trials.empty()) return "There are no frames to show. Run a measurement first.";
  // Answers to a session that takes none would be lost; its report may just be written.
  if (const auto intact = require_intact(session); !intact) return QString::fromStdString(intact.error().message);
  options_ = options;
  plan_ = plan;
  session_ = session;
  patches_ = patches_for_a_person(trials, options);
  training_ = patches_for_training(trials, options);
  trained_ = 0;
  feedback_.clear();
  means_.clear();
  answers_.clear();
  shown_.clear();
  record_.reset();
  problem_.clear();
  show_next();
  return {};
}

void HumanPresenter::show_next() {
  if (answers_.size() == patches_.size()) {
    finish();
    return;
  }
  const JudgedTrial& next = training_left() > 0 ? training_[trained_] : patches_[answers_.size()];
  picture_ =
      at_display() ? picture_at_display(next, plan_.display) : picture_for_a_person(next, options_.magnification);
  state_ = HumanState::showing;
  since_shown_.start();
  if (options_.shown_ms) hide_.start(*options_.shown_ms);
  emit updated();
}

void HumanPresenter::answer(Apex apex) {
  if (state_ != HumanState::showing && state_ != HumanState::hidden) return;
  hide_.stop();
  if (training_left() > 0) {
    const Apex truth = training_[trained_++].trial.truth;
    const auto word = to_string(truth);
    feedback_ = (apex == truth ? "✓ right: " : "✗ it pointed ") +
                QString::fromUtf8(word.data(), static_cast<qsizetype>(word.size()));
    if (training_left() == 0) feedback_ += ". From now on the answers count, without feedback.";
    show_next();
    return;
  }
  feedback_.clear();
  const JudgedTrial& patch = patches_[answers_.size()];
  const LevelSpan grey = at_display() ? grey_levels(patch, plan_.display) : grey_levels(patch);
  shown_.push_back({.kelvin = patch.patch_k,
                    .black_k = grey.low,
                    .white_k = grey.high,
                    .magnification = at_display() ? static_cast<int>(plan_.display.zoom) : options_.magnification,
                    .limit_ms = options_.shown_ms,
                    .response_s = static_cast<double>(since_shown_.nsecsElapsed()) * 1e-9,
                    .noise_k = patch.noise_k});
  Trial trial = patch.trial;
  trial.answer = apex;
  trial.scores = {};
  // Remove the model's answer: this trial is the person's.
  trial.probability_correct.reset();
  trial.frames = 1;
  answers_.push_back(std::move(trial));
  show_next();
}

void HumanPresenter::abort() {
  if (state_ == HumanState::idle || state_ == HumanState::finished) return;
  hide_.stop();
  if (answers_.empty()) {
    state_ = HumanState::idle;
    emit updated();
    return;
  }
  finish();
}

void HumanPresenter::finish() {
  picture_ = {};
  state_ = HumanState::finished;
  auto record = human_record(answers_, shown_, plan_);
  if (!record) {
    problem_ = QString::fromStdString(record.error().message);
  } else {
    record_ = std::move(*record);
    PersonRecord person{.person = options_.person, .record = *record_};
    person.person.judged_utc = utc_now();
    person.person.training_answers = static_cast<int>(trained_);
    if (auto written = add_person(session_, person); !written) {
      problem_ = QString::fromStdString(written.error().message);
    } else if (const auto people = read_people(session_)) {
      means_ = mean_over_people(*people);
    }
  }
  emit updated();
  emit finished(QString::fromStdString(session_.string()));
}

}  // namespace todbench
