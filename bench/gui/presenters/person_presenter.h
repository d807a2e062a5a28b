// SPDX-License-Identifier: GPL-3.0-or-later
// A person in place of the observer of `identify` or `mrtd`: frames in sequence, answered by their alternatives,
// without feedback.
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

/// The question to a person, as entered on the page.
struct PersonQuestion {
  PersonTask task = PersonTask::identify;
  std::string sensor = "sc2000";
  std::string set = "small-craft";                      ///< identify
  std::vector<double> ranges_m{};                       ///< identify
  std::string atmosphere = "clear";                     ///< identify: load_atmosphere()
  std::vector<double> of_nyquist{};                     ///< bars: frequencies
  BarAxis axis = BarAxis::horizontal;                   ///< bars
  BarCriterion criterion = BarCriterion::four_or_five;  ///< bars
  int each = 2;                                         ///< per target and range, or per contrast and frequency
  std::uint64_t seed = 1;
};
/// Computes the frames of a question at the accuracy `normal`. Errors: those of the loaders and of PersonExperiment.
[[nodiscard]] Result<PersonExperiment> person_experiment(const PersonQuestion& question);

/// Used in the window's thread.
class PersonPresenter final : public QObject {
  Q_OBJECT

 public:
  explicit PersonPresenter(QObject* parent = nullptr);

  /// Answers are written to a new folder in `sessions`, with the facts of the person.
  void begin(PersonExperiment experiment, const PersonFacts& person, const std::filesystem::path& sessions,
             std::optional<int> shown_ms, int magnification = 24);
  /// The person's answer to the frame shown now or last.
  void answer(std::size_t alternative);
  /// Ends with the answers so far.
  void abort();

  [[nodiscard]] HumanState state() const { return screen_.state(); }
  [[nodiscard]] const QImage& picture() const { return screen_.picture(); }
  [[nodiscard]] const std::optional<PersonExperiment>& experiment() const { return experiment_; }
  [[nodiscard]] const std::vector<ExperimentAnswer>& answers() const { return answers_; }
  /// Folder of the written answers; empty before.
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
  /// Reason why the answers could not be stored; otherwise empty.
  [[nodiscard]] QString problem() const { return problem_; }

 signals:
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
