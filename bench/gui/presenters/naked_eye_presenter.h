// SPDX-License-Identifier: GPL-3.0-or-later
// A person before the calibrated display, without camera and sensor: triangles, arrow keys, no feedback.
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

/// The question to a person, as entered on the page.
struct NakedEyeQuestion {
  std::vector<double> contrasts{0.4, 0.15, 0.06};
  double noise = 0;
  int per_size = 12;
  PersonFacts person{};
};

/// The picture with `zoom` screen pixels on a side of each sample.
[[nodiscard]] QImage screen_picture(const NakedEyePicture& picture, int zoom);

/// Used in the window's thread; the prediction runs on a thread of its own.
class NakedEyePresenter final : public QObject {
  Q_OBJECT

 public:
  explicit NakedEyePresenter(QObject* parent = nullptr);

  /// Predicts for hvs-2 at the display of the plan, writes the prediction to a new folder in `sessions`, then shows the
  /// first triangle. Returns an error sentence; empty: it has begun.
  [[nodiscard]] QString begin(const Plan& plan, const NakedEyeQuestion& question, const std::filesystem::path& sessions,
                              std::optional<int> shown_ms);
  /// The person's answer to the picture shown now or last.
  void answer(Apex apex);
  /// Stops the prediction, or ends with the answers so far.
  void abort();

  [[nodiscard]] bool predicting() const { return predicting_; }
  [[nodiscard]] HumanState state() const { return screen_.state(); }
  [[nodiscard]] const QImage& picture() const { return screen_.picture(); }
  /// Level around the picture, 0 to 255.
  [[nodiscard]] int background_level() const;
  [[nodiscard]] const std::optional<NakedEyeSession>& session() const { return session_; }
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
  /// Reason why nothing was shown or stored; otherwise empty.
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
