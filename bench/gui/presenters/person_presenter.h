// A person in place of the observer of `identify` or `mrtd`: one frame after the other, answered by its alternatives,
// without feedback.
#pragma once

#include <QElapsedTimer>
#include <QImage>
#include <QObject>
#include <QString>
#include <QTimer>
#include <filesystem>
#include <optional>
#include <vector>

#include "bench/gui/presenters/human_presenter.h"
#include "bench/studies/person_experiment.h"

namespace todbench {

/// An alternative as an icon: white hot on the grey of the background, whatever the theme.
[[nodiscard]] QImage icon_image(const cv::Mat1d& icon);

/// What a person is asked, in the words of the page.
struct PersonQuestion {
  PersonTask task = PersonTask::identify;
  std::string sensor = "sc2000";
  std::string set = "small-craft";                      ///< identify
  std::vector<double> ranges_m{};                       ///< identify
  std::string atmosphere = "clear";                     ///< identify: load_atmosphere()
  std::vector<double> of_nyquist{};                     ///< bars: frequencies
  BarAxis axis = BarAxis::horizontal;                   ///< bars
  BarCriterion criterion = BarCriterion::four_or_five;  ///< bars
  int each = 2;  ///< of every target and range, or of every contrast and frequency
  std::uint64_t seed = 1;
};
/// The frames of that question, at the accuracy `normal`. Errors: of the loaders and of PersonExperiment.
[[nodiscard]] Result<PersonExperiment> person_experiment(const PersonQuestion& question);

/// In the window's thread.
class PersonPresenter final : public QObject {
  Q_OBJECT

 public:
  explicit PersonPresenter(QObject* parent = nullptr);

  /// Answers go into a new folder below `sessions`.
  void begin(PersonExperiment experiment, const std::filesystem::path& sessions, std::optional<int> shown_ms,
             int magnification = 24);
  /// The person's choice for the frame that is or was shown.
  void answer(std::size_t alternative);
  /// Ends with the answers so far.
  void abort();

  [[nodiscard]] HumanState state() const { return state_; }
  [[nodiscard]] const QImage& picture() const { return picture_; }
  [[nodiscard]] const std::optional<PersonExperiment>& experiment() const { return experiment_; }
  [[nodiscard]] const std::vector<PersonAnswer>& answers() const { return answers_; }
  /// Where they were written; empty before.
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
  /// Why the answers could not be kept; empty otherwise.
  [[nodiscard]] QString problem() const { return problem_; }

 signals:
  void updated();

 private:
  void show_next();
  void finish();

  std::optional<PersonExperiment> experiment_;
  std::filesystem::path sessions_, folder_;
  std::optional<int> shown_ms_;
  int magnification_ = 24;
  std::vector<PersonAnswer> answers_;
  QElapsedTimer since_shown_;
  QImage picture_;
  HumanState state_ = HumanState::idle;
  QString problem_;
  QTimer hide_;
};

}  // namespace todbench
