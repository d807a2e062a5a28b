// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/presenters/human_presenter.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "bench/gui/presenters/colour_map.h"
#include "bench/gui/presenters/text_of.h"
#include "bench/session/open_session.h"
#include "bench/session/provenance.h"
#include "hvs/eye/display_levels.h"

namespace todbench {
namespace {

double median(cv::Mat1f values) {
  std::vector<float> sorted(values.begin(), values.end());
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  return *middle;
}

}  // namespace

std::vector<JudgedTrial> patches_for_a_person(const std::vector<JudgedTrial>& trials, const HumanOptions& options) {
  const RandomStream stream(options.seed, "human");
  std::vector<std::size_t> chosen = balanced_choice(trials, options.per_size, stream);
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
  connect(&screen_, &PictureTimer::updated, this, &HumanPresenter::updated);
}

void HumanPresenter::start(const Plan& plan, const std::filesystem::path& folder, const HumanOptions& options) {
  options_ = options;
  plan_ = plan;
  session_ = folder;
  blind_.reset();
  blind_result_.reset();
  patches_.clear();
  training_.clear();
  trained_ = 0;
  feedback_.clear();
  means_.clear();
  answers_.clear();
  shown_.clear();
  record_.reset();
  problem_.clear();
}

QString HumanPresenter::begin(const std::vector<JudgedTrial>& trials, const Plan& plan,
                              const std::filesystem::path& session, const HumanOptions& options) {
  if (trials.empty()) return "There are no frames to show. Run a measurement first.";
  // Answers to a session that takes none would be lost; its report may just be written.
  if (const auto intact = require_intact(session); !intact) return QString::fromStdString(intact.error().message);
  start(plan, session, options);
  for (JudgedTrial& judged : patches_for_a_person(trials, options)) patches_.push_back({0, std::move(judged), 1});
  training_ = patches_for_training(trials, options);
  show_next();
  return {};
}

QString HumanPresenter::begin_blind(const std::filesystem::path& session, const std::vector<std::string>& packages,
                                    bool with_twin, const Plan& plan, const std::filesystem::path& folder,
                                    const HumanOptions& options) {
  std::vector<EnhancementPackage> read;
  for (const std::string& file : packages) {
    auto package = read_package(file);
    if (!package) return QString::fromStdString(package.error().message);
    read.push_back(*std::move(package));
  }
  if (read.empty() && !with_twin) return "State at least one package, or select the simulated twin.";
  start(plan, folder, options);
  screen_.end(HumanState::idle);
  preparing_ = true;
  jobs_.start([this, session, read, with_twin, folder, options](const std::stop_token& stop) {
    auto made = std::make_shared<Result<Blind>>(Blind{});
    const auto sources = blind_sources(session, read, with_twin, folder, {}, stop);
    Result<std::vector<BlindPatch>> patches =
        sources ? blind_order(*sources, options.per_size, options.seed) : tl::unexpected(sources.error());
    if (!patches) {
      *made = tl::unexpected(patches.error());
    } else {
      for (const BlindSource& source : *sources) (*made)->names.push_back(source.name);
      (*made)->patches = *std::move(patches);
    }
    QMetaObject::invokeMethod(
        this, [this, made] { take(std::move(*made)); }, Qt::QueuedConnection);
  });
  emit updated();
  return {};
}

void HumanPresenter::take(Result<Blind> blind) {
  if (!preparing_) return;
  preparing_ = false;
  if (!blind) {
    problem_ = QString::fromStdString(blind.error().message);
    emit updated();
    return;
  }
  blind_ = *std::move(blind);
  patches_ = blind_->patches;
  std::vector<JudgedTrial> trials;
  for (const BlindPatch& patch : patches_) {
    if (patch.samples_per_pixel == 1) trials.push_back(patch.judged);
  }
  training_ = patches_for_training(trials, options_);
  show_next();
}

void HumanPresenter::show_next() {
  if (answers_.size() == patches_.size()) {
    finish();
    return;
  }
  const bool trains = training_left() > 0;
  const JudgedTrial& next = trains ? training_[trained_] : patches_[answers_.size()].judged;
  const int samples = trains ? 1 : patches_[answers_.size()].samples_per_pixel;
  screen_.show(at_display() ? picture_at_display(next, plan_.display)
                            : picture_for_a_person(next, std::max(1, options_.magnification / samples)),
               options_.shown_ms);
}

void HumanPresenter::answer(Apex apex) {
  const auto response_s = screen_.take_answer();
  if (!response_s) return;
  if (training_left() > 0) {
    const Apex truth = training_[trained_++].trial.truth;
    feedback_ = (apex == truth ? "✓ correct: " : "✗ it pointed ") + text_of(to_string(truth));
    if (training_left() == 0) feedback_ += ". From now on the answers count, without feedback.";
    show_next();
    return;
  }
  feedback_.clear();
  const BlindPatch& patch = patches_[answers_.size()];
  const LevelSpan grey = at_display() ? grey_levels(patch.judged, plan_.display) : grey_levels(patch.judged);
  shown_.push_back({.kelvin = patch.judged.patch_k,
                    .black_k = grey.low,
                    .white_k = grey.high,
                    .magnification = at_display() ? static_cast<int>(plan_.display.zoom)
                                                  : std::max(1, options_.magnification / patch.samples_per_pixel),
                    .limit_ms = options_.shown_ms,
                    .response_s = *response_s,
                    .noise_k = patch.judged.noise_k});
  Trial trial = patch.judged.trial;
  trial.answer = apex;
  trial.scores = {};
  // Remove the model's answer: this trial is the person's.
  trial.probability_correct.reset();
  trial.frames = 1;
  answers_.push_back(std::move(trial));
  show_next();
}

void HumanPresenter::abort() {
  if (preparing_) {
    preparing_ = false;
    jobs_.stop();
    emit updated();
    return;
  }
  if (!screen_.awaits_answer()) return;
  if (answers_.empty()) {
    screen_.end(HumanState::idle);
    emit updated();
    return;
  }
  finish();
}

void HumanPresenter::finish() {
  screen_.end(HumanState::finished);
  PersonFacts person = options_.person;
  person.judged_utc = utc_now();
  person.training_answers = static_cast<int>(trained_);
  if (blind_) {
    std::vector<BlindAnswer> answers;
    for (std::size_t i = 0; i < answers_.size(); ++i) answers.push_back({patches_[i].source, answers_[i], shown_[i]});
    auto result = todbench::blind_result(blind_->names, answers, plan_);
    auto written = result ? write_blind(session_, *result, answers, person, options_.seed)
                          : Result<void>(tl::unexpected(result.error()));
    if (!written) problem_ = QString::fromStdString(written.error().message);
    if (result) blind_result_ = *std::move(result);
    emit updated();
    return;
  }
  auto record = human_record(answers_, shown_, plan_);
  if (!record) {
    problem_ = QString::fromStdString(record.error().message);
  } else {
    record_ = std::move(*record);
    if (auto written = add_person(session_, {.person = person, .record = *record_}); !written) {
      problem_ = QString::fromStdString(written.error().message);
    } else if (const auto people = read_people(session_)) {
      means_ = mean_over_people(*people);
    }
  }
  emit updated();
  emit finished(QString::fromStdString(session_.string()));
}

}  // namespace todbench
