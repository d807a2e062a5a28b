// SPDX-License-Identifier: GPL-3.0-or-later
// Experiment with a person in place of the observer of `identify` or `mrtd`: frames in sequence, each with its
// alternatives, without feedback.
#pragma once

#include <QImage>
#include <QObject>
#include <QString>
#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

#include "bench/gui/presenters/picture_timer.h"
#include "bench/studies/person_experiment.h"

namespace todbench {

/// Returns "person-20260131T123456Z-TASK" in `sessions`, with a number if the name is already used in this second.
[[nodiscard]] std::filesystem::path new_person_folder(const std::filesystem::path& sessions, std::string_view task);
/// Returns an alternative as an icon: white hot on the grey of the background, for every theme.
[[nodiscard]] QImage icon_image(const cv::Mat1d& icon);

/// Experiment as entered on the page.
struct PersonQuestion {
  /// Task of the person: identification of targets, or judgement of bars.
  PersonTask task = PersonTask::identify;
  /// Name or file of the simulated sensor.
  std::string sensor = "sc2000";
  /// Set of targets, for `identify`.
  std::string set = "small-craft";
  /// Ranges in m, for `identify`.
  std::vector<double> ranges_m{};
  /// Air between targets and sensor, as for load_atmosphere(); for `identify`.
  std::string atmosphere = "clear";
  /// Frequencies of the bars as fractions of the Nyquist frequency, for bars.
  std::vector<double> of_nyquist{};
  /// Axis that the bars test, for bars.
  BarAxis axis = BarAxis::horizontal;
  /// Question about the bars, for bars.
  BarCriterion criterion = BarCriterion::four_or_five;
  /// Frames per target and range, or per contrast and frequency.
  int each = 2;
  /// Seed of noise and order.
  std::uint64_t seed = 1;
};
/// Computes the frames of a question at the accuracy `normal`. Errors: those of the loaders and of PersonExperiment.
[[nodiscard]] Result<PersonExperiment> person_experiment(const PersonQuestion& question);

/// Presenter of the experiment. Used in the window's thread.
class PersonPresenter final : public QObject {
  Q_OBJECT

 public:
  explicit PersonPresenter(QObject* parent = nullptr);

  /// Shows the first frame. The answers are written to a new folder in `sessions`, with the facts of the person.
  /// `shown_ms`: display time of a frame; empty: until it is answered. `magnification`: screen pixels per sample.
  void begin(PersonExperiment experiment, const PersonFacts& person, const std::filesystem::path& sessions,
             std::optional<int> shown_ms, int magnification = 24);
  /// Records the answer of the person to the frame shown now or last.
  void answer(std::size_t alternative);
  /// Ends the experiment and keeps the answers.
  void abort();

  /// Returns the state of the display.
  [[nodiscard]] HumanState state() const { return screen_.state(); }
  /// Returns the frame on the screen.
  [[nodiscard]] const QImage& picture() const { return screen_.picture(); }
  /// Returns the experiment; empty before begin().
  [[nodiscard]] const std::optional<PersonExperiment>& experiment() const { return experiment_; }
  /// Returns the answers in the order of the trials.
  [[nodiscard]] const std::vector<ExperimentAnswer>& answers() const { return answers_; }
  /// Returns the folder of the answers; empty before they are written.
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
  /// Returns the reason why the answers could not be stored; otherwise empty.
  [[nodiscard]] QString problem() const { return problem_; }

 signals:
  /// The frame, the state or the answers changed.
  void updated();

 private:
  void show_next();
  void finish();

  std::optional<PersonExperiment> experiment_;
  PersonFacts facts_;
  std::filesystem::path sessions_, folder_;
  std::optional<int> shown_ms_;
  int magnification_ = 24;
  std::vector<ExperimentAnswer> answers_;
  PictureTimer screen_;
  QString problem_;
};

}  // namespace todbench
