// SPDX-License-Identifier: GPL-3.0-or-later
// Presentation of the judged patches to a person: four alternatives, arrow keys, no feedback. The answers of the model
// are not shown.
#pragma once

#include <QImage>
#include <QObject>
#include <QString>
#include <filesystem>
#include <optional>
#include <vector>

#include "bench/enhance/blind_judgement.h"
#include "bench/gui/presenters/colour_map.h"
#include "bench/gui/presenters/job_runner.h"
#include "bench/gui/presenters/measure_presenter.h"
#include "bench/gui/presenters/picture_timer.h"
#include "bench/session/human_record.h"

namespace todbench {

/// Options of a sitting.
struct HumanOptions {
  int per_size = 8;             ///< patches per contrast and size, or all if there are fewer
  std::optional<int> shown_ms;  ///< empty: until answered
  int magnification = 24;       ///< screen pixels per pixel of the camera, if the plan has no display
  std::uint64_t seed = 1;
  int training = 0;      ///< patches with feedback before the first patch that counts
  PersonFacts person{};  ///< stored with the answers
};

/// Returns a balanced random choice of the camera's patches in random order.
[[nodiscard]] std::vector<JudgedTrial> patches_for_a_person(const std::vector<JudgedTrial>& trials,
                                                            const HumanOptions& options);
/// Returns `options.training` patches for the training: the largest triangles at the highest contrasts, in random
/// order. These easy patches show the person the task.
[[nodiscard]] std::vector<JudgedTrial> patches_for_training(const std::vector<JudgedTrial>& trials,
                                                            const HumanOptions& options);
/// Returns the temperatures that are displayed as black and as white.
[[nodiscard]] LevelSpan grey_levels(const JudgedTrial& judged);
/// Returns the temperatures that operator_picture() shows as black and as white on the display of the plan.
[[nodiscard]] LevelSpan grey_levels(const JudgedTrial& judged, const ViewedDisplay& display);
/// Returns the patch as an operator sees it at the display, in pixels of the screen.
[[nodiscard]] QImage picture_at_display(const JudgedTrial& judged, const ViewedDisplay& display);
/// Returns the patch enlarged by bicubic interpolation. The grey scale spans at least three contrasts around the
/// surround. The grey scale does not depend on the direction of the triangle and therefore does not reveal the answer.
[[nodiscard]] QImage picture_for_a_person(const JudgedTrial& judged, int magnification);

/// Presenter of the patches. Used in the window's thread.
class HumanPresenter final : public QObject {
  Q_OBJECT

 public:
  explicit HumanPresenter(QObject* parent = nullptr);

  /// Starts with the patches of a finished run. Returns an error sentence; empty: success.
  [[nodiscard]] QString begin(const std::vector<JudgedTrial>& trials, const Plan& plan,
                              const std::filesystem::path& session, const HumanOptions& options);
  /// Replays a recorded session, also through packages, and shows the patches of all sources in one mixed order. No
  /// member reveals the source of a patch. The answers are written to `folder`. Returns an error sentence; empty: the
  /// sources are being computed.
  [[nodiscard]] QString begin_blind(const std::filesystem::path& session, const std::vector<std::string>& packages,
                                    bool with_twin, const Plan& plan, const std::filesystem::path& folder,
                                    const HumanOptions& options);
  /// Records the answer of the person to the patch shown now or last.
  void answer(Apex apex);
  void abort();

  [[nodiscard]] HumanState state() const { return screen_.state(); }
  [[nodiscard]] const QImage& picture() const { return screen_.picture(); }
  /// Returns whether the sources of begin_blind() are being computed.
  [[nodiscard]] bool preparing() const { return preparing_; }
  /// Returns the grey level around the picture, which is the level of the background, 0 to 255.
  [[nodiscard]] int background_level() const;
  /// Returns whether picture() is in pixels of the screen, because the plan has a display.
  [[nodiscard]] bool at_display() const { return !blind_ && has_display(plan_); }
  /// Returns the number of answers that count.
  [[nodiscard]] std::size_t done() const { return answers_.size(); }
  /// Returns the number of patches whose answers count.
  [[nodiscard]] std::size_t planned() const { return patches_.size(); }
  /// Returns the number of patches of the training that are still to be answered; 0: the answers count.
  [[nodiscard]] std::size_t training_left() const { return training_.size() - trained_; }
  /// Returns whether the last answer of the training was correct, in words; empty outside the training.
  [[nodiscard]] const QString& feedback() const { return feedback_; }
  /// Returns, after the end, the mean over all people of the session.
  [[nodiscard]] const std::vector<PeopleMean>& means() const { return means_; }
  /// Returns, after the end, the record written to the session.
  [[nodiscard]] const std::optional<HumanRecord>& record() const { return record_; }
  /// Returns, after the end of a blind judgement, its sources and ratios.
  [[nodiscard]] const std::optional<BlindResult>& blind_result() const { return blind_result_; }
  /// Returns the folder of the blind judgement.
  [[nodiscard]] const std::filesystem::path& folder() const { return session_; }
  /// Returns the reason why the answers could not be stored; otherwise empty.
  [[nodiscard]] QString problem() const { return problem_; }

 signals:
  void updated();
  void finished(const QString& session);

 private:
  /// Sources that are ready to be judged.
  struct Blind {
    std::vector<std::string> names;
    std::vector<BlindPatch> patches;
  };
  void start(const Plan& plan, const std::filesystem::path& folder, const HumanOptions& options);
  void take(Result<Blind> blind);
  void show_next();
  void finish();

  HumanOptions options_;
  Plan plan_;
  std::filesystem::path session_;
  std::optional<Blind> blind_;
  std::optional<BlindResult> blind_result_;
  bool preparing_ = false;
  std::vector<BlindPatch> patches_;
  std::vector<JudgedTrial> training_;
  std::size_t trained_ = 0;
  QString feedback_;
  std::vector<PeopleMean> means_;
  std::vector<Trial> answers_;
  std::vector<ShownPatch> shown_;
  PictureTimer screen_;
  std::optional<HumanRecord> record_;
  QString problem_;
  JobRunner jobs_;
};

}  // namespace todbench
