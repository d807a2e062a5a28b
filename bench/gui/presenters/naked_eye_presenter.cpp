// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/presenters/naked_eye_presenter.h"

#include <memory>
#include <opencv2/imgproc.hpp>
#include <string>
#include <utility>

#include "bench/gui/presenters/colour_map.h"
#include "bench/gui/presenters/person_presenter.h"
#include "bench/gui/presenters/plan_advice.h"
#include "bench/plan/descriptions.h"
#include "bench/session/provenance.h"
#include "hvs/eye/display_levels.h"

namespace todbench {
namespace {

constexpr int pictures_of_the_prediction = 48;

}  // namespace

QImage screen_picture(const NakedEyePicture& picture, int zoom) {
  cv::Mat1b pixels;
  cv::resize(picture.levels, pixels, {}, zoom, zoom, cv::INTER_NEAREST);
  return grey_image(pixels);
}

int NakedEyePresenter::background_level() const {
  return session_ ? background_level_of(*session_->task().model.display) : 128;
}

NakedEyePresenter::NakedEyePresenter(QObject* parent) : QObject(parent) {
  connect(&screen_, &PictureTimer::updated, this, &NakedEyePresenter::updated);
}

QString NakedEyePresenter::begin(const Plan& plan, const NakedEyeQuestion& question,
                                 const std::filesystem::path& sessions, std::optional<int> shown_ms) {
  if (!has_display(plan)) return no_display_sentence;
  auto model = load_observer_at("hvs-2", plan.display);
  if (!model) return QString::fromStdString(model.error().message);
  const NakedEyeTask task{.model = *std::move(model),
                          .contrasts = question.contrasts,
                          .noise = question.noise,
                          .per_size = question.per_size,
                          .seed = plan.seed};
  if (const auto possible = validate(task); !possible) return QString::fromStdString(possible.error().message);
  folder_ = new_person_folder(sessions, "naked-eye");
  shown_ms_ = shown_ms;
  facts_ = question.person;
  session_.reset();
  problem_.clear();
  screen_.end(HumanState::idle);
  predicting_ = true;
  jobs_.start([this, task, folder = folder_](const std::stop_token& stop) {
    auto made = std::make_shared<Result<NakedEyeSession>>(
        NakedEyeSession::begin(task, folder, pictures_of_the_prediction, stop));
    QMetaObject::invokeMethod(
        this, [this, made] { take(std::move(*made)); }, Qt::QueuedConnection);
  });
  emit updated();
  return {};
}

void NakedEyePresenter::take(Result<NakedEyeSession> session) {
  if (!predicting_) return;
  predicting_ = false;
  if (session)
    session_ = *std::move(session);
  else
    problem_ = QString::fromStdString(session.error().message);
  if (session_)
    show_next();
  else
    emit updated();
}

void NakedEyePresenter::show_next() {
  if (session_->complete()) {
    finish();
    return;
  }
  screen_.show(screen_picture(session_->picture(), static_cast<int>(session_->task().model.display->zoom)), shown_ms_);
}

void NakedEyePresenter::answer(Apex apex) {
  const auto response_s = screen_.take_answer();
  if (!response_s) return;
  session_->answer(apex, *response_s, shown_ms_);
  show_next();
}

void NakedEyePresenter::abort() {
  if (predicting_) {
    predicting_ = false;
    jobs_.stop();
    emit updated();
    return;
  }
  if (!screen_.awaits_answer()) return;
  if (session_->done() > 0) {
    finish();
    return;
  }
  screen_.end(HumanState::idle);
  emit updated();
}

void NakedEyePresenter::finish() {
  screen_.end(HumanState::finished);
  facts_.judged_utc = utc_now();
  if (const auto written = session_->finish(facts_); !written)
    problem_ = QString::fromStdString(written.error().message);
  emit updated();
}

}  // namespace todbench
