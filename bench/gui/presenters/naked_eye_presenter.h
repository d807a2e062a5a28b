// SPDX-License-Identifier: GPL-3.0-or-later
// Experiment with a person in front of the calibrated display, without camera and sensor: triangles, arrow keys, no
// feedback.
#pragma once

#include <QImage>
#include <QObject>
#include <QString>
#include <filesystem>
#include <optional>
#include <vector>

#include "bench/gui/presenters/job_runner.h"
#include "bench/gui/presenters/picture_timer.h"
#include "bench/naked_eye/naked_eye_session.h"
#include "bench/plan/plan.h"

namespace todbench {

/// Experiment as entered on the page.
struct NakedEyeQuestion {
  /// Luminance contrasts of the triangles.
  std::vector<double> contrasts{0.4, 0.15, 0.06};
  /// Standard deviation of white noise per displayed sample, as a luminance contrast.
  double noise = 0;
  /// Triangles per contrast and size.
  int per_size = 12;
  /// Facts of the person.
  PersonFacts person{};
};

/// Returns the picture with `zoom` x `zoom` screen pixels for each sample.
[[nodiscard]] QImage screen_picture(const NakedEyePicture& picture, int zoom);

/// Presenter of the experiment. Used in the window's thread; the prediction runs on its own thread.
class NakedEyePresenter final : public QObject {
  Q_OBJECT

 public:
  explicit NakedEyePresenter(QObject* parent = nullptr);

  /// Computes the prediction for hvs-2 at the display of the plan, writes it to a new folder in `sessions`, and then
  /// shows the first triangle. Returns an error sentence; empty: the experiment has begun.
  [[nodiscard]] QString begin(const Plan& plan, const NakedEyeQuestion& question, const std::filesystem::path& sessions,
                              std::optional<int> shown_ms);
  /// Records the answer of the person to the picture shown now or last.
  void answer(Apex apex);
  /// Stops the prediction, or ends the experiment and keeps the answers.
  void abort();

  /// Returns whether the prediction is being computed.
  [[nodiscard]] bool predicting() const { return predicting_; }
  [[nodiscard]] HumanState state() const { return screen_.state(); }
  [[nodiscard]] const QImage& picture() const { return screen_.picture(); }
  /// Returns the level around the picture, 0 to 255.
  [[nodiscard]] int background_level() const;
  /// Returns the session with its answers; empty before the prediction is complete.
  [[nodiscard]] const std::optional<NakedEyeSession>& session() const { return session_; }
  /// Returns the folder of the experiment.
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
  /// Returns the reason why a picture was not shown or not stored; otherwise empty.
  [[nodiscard]] QString problem() const { return problem_; }

 signals:
  void updated();

 private:
  void take(Result<NakedEyeSession> session);
  void show_next();
  void finish();

  std::filesystem::path folder_;
  std::optional<int> shown_ms_;
  PersonFacts facts_;
  std::optional<NakedEyeSession> session_;
  PictureTimer screen_;
  bool predicting_ = false;
  QString problem_;
  JobRunner jobs_;
};

}  // namespace todbench
