// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/presenters/person_presenter.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <string_view>
#include <utility>

#include "acquisition/base/try.h"
#include "bench/gui/presenters/colour_map.h"
#include "bench/plan/atmospheres.h"
#include "bench/plan/descriptions.h"
#include "bench/session/provenance.h"
#include "bench/session/session_folder.h"
#include "bench/studies/pictured_scenes.h"
#include "bench/text/files.h"

namespace todbench {
namespace {

/// Room above three rows of icons on the smallest page.
constexpr int widest_px = 800, highest_px = 360;

/// Enlarges by bicubic interpolation with an integer factor that fits on the screen.
QImage picture_of(const cv::Mat1f& kelvin, const GreyScale& grey, int magnification) {
  const int factor = std::max(1, std::min({magnification, widest_px / kelvin.cols, highest_px / kelvin.rows}));
  cv::Mat1d fine;
  cv::resize(cv::Mat1d(kelvin), fine, {}, factor, factor, cv::INTER_CUBIC);
  return to_image(fine, {grey.black_k, grey.white_k}, ColourMap::white_hot);
}

}  // namespace

std::filesystem::path new_person_folder(const std::filesystem::path& sessions, std::string_view task) {
  constexpr std::string_view before = "session";
  const std::string name = "person" + session_folder_name(std::string(task)).substr(before.size());
  std::filesystem::path folder = sessions / name;
  for (int number = 2; is_there(folder); ++number) folder = sessions / (name + "-" + std::to_string(number));
  return folder;
}

QImage icon_image(const cv::Mat1d& icon) {
  return to_image(icon, {0, 1}, ColourMap::white_hot);
}

Result<PersonExperiment> person_experiment(const PersonQuestion& question) {
  TODBENCH_TRY(auto sensor, load_sensor(question.sensor));
  if (question.task == PersonTask::bars) {
    VirtualMrtdTask task;
    task.sensor = std::move(sensor);
    task.plan = full_plan(task.sensor, {}, {});
    task.accuracy = Accuracy::normal();
    task.axis = question.axis;
    task.criterion = question.criterion;
    task.seed = question.seed;
    const double nyquist = 0.5 * task.sensor.samples_per_pitch() / task.sensor.ifov_mrad();
    for (const double share : question.of_nyquist) task.frequencies_per_mrad.push_back(share * nyquist);
    return PersonExperiment::of_bars(task, question.each);
  }
  TODBENCH_TRY(auto set, target_set_with_pictures(question.set));
  auto air = load_atmosphere(question.atmosphere, {.band = {sensor.wavelength_min_um, sensor.wavelength_max_um},
                                                   .weight_temperature_k = sensor.scene_temperature_k});
  if (!air) return tl::unexpected(air.error());
  IdentificationStudyTask task;
  task.set = std::move(set);
  task.air = *std::move(air);
  task.sensor = std::move(sensor);
  task.accuracy = Accuracy::normal();
  task.ranges_m = question.ranges_m;
  task.seed = question.seed;
  return PersonExperiment::of_set(task, question.each);
}

PersonPresenter::PersonPresenter(QObject* parent) : QObject(parent) {
  connect(&screen_, &PictureTimer::updated, this, &PersonPresenter::updated);
}

void PersonPresenter::begin(PersonExperiment experiment, const PersonFacts& person,
                            const std::filesystem::path& sessions, std::optional<int> shown_ms, int magnification) {
  experiment_ = std::move(experiment);
  facts_ = person;
  sessions_ = sessions;
  shown_ms_ = shown_ms;
  magnification_ = magnification;
  folder_.clear();
  answers_.clear();
  problem_.clear();
  show_next();
}

void PersonPresenter::show_next() {
  if (answers_.size() == experiment_->trials().size()) {
    finish();
    return;
  }
  const PersonTrial& trial = experiment_->trials()[answers_.size()];
  const auto kelvin = experiment_->picture_k(trial);
  if (!kelvin) {
    problem_ = QString::fromStdString(kelvin.error().message);
    screen_.end(HumanState::finished);
    emit updated();
    return;
  }
  screen_.show(picture_of(*kelvin, experiment_->grey(trial), magnification_), shown_ms_);
}

void PersonPresenter::answer(std::size_t alternative) {
  if (!experiment_ || alternative >= experiment_->alternatives().size()) return;
  const auto response_s = screen_.take_answer();
  if (!response_s) return;
  answers_.push_back({.answer = alternative, .response_s = *response_s, .limit_ms = shown_ms_});
  show_next();
}

void PersonPresenter::abort() {
  if (!screen_.awaits_answer()) return;
  if (!answers_.empty()) {
    finish();
    return;
  }
  screen_.end(HumanState::idle);
  emit updated();
}

void PersonPresenter::finish() {
  screen_.end(HumanState::finished);
  const auto folder = new_person_folder(sessions_, to_string(experiment_->task()));
  const bool complete = answers_.size() == experiment_->trials().size();
  facts_.judged_utc = utc_now();
  if (auto written = write_person(folder, *experiment_, answers_, facts_, complete); !written)
    problem_ = QString::fromStdString(written.error().message);
  else
    folder_ = folder;
  emit updated();
}

}  // namespace todbench
