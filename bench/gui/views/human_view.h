// SPDX-License-Identifier: GPL-3.0-or-later
// Human observer view: one patch and four keys, or a frame and its alternatives as icons.
#pragma once

#include <QWidget>

class QCheckBox;
class QComboBox;
class QFormLayout;
class QLabel;
class QLineEdit;
class QPushButton;
class QSpinBox;

namespace todbench {

class AlternativesPanel;
class HumanPresenter;
class LimitsPanel;
class MeasurePresenter;
class NakedEyePresenter;
class PersonFields;
class PersonPresenter;
class PictureView;
class PlanAdvice;
class Workbench;
enum class BarCriterion;
struct PersonFacts;

/// Page of the human observer.
class HumanView final : public QWidget {
  Q_OBJECT

 public:
  HumanView(Workbench& bench, HumanPresenter& presenter, PersonPresenter& person, MeasurePresenter& measured,
            QWidget* parent = nullptr);

 protected:
  void keyPressEvent(QKeyEvent* event) override;

 private:
  [[nodiscard]] QWidget* side_panel();
  void add_questions(QFormLayout& form);
  [[nodiscard]] bool triangles() const;
  /// Returns whether the question is about frames of a sensor with triangles.
  [[nodiscard]] bool of_frames() const;
  [[nodiscard]] BarCriterion criterion() const;
  void begin();
  void begin_person(const PersonFacts& facts);
  void begin_naked_eye(const PersonFacts& facts);
  void add_proposal(QFormLayout& form);
  void show_question();
  void show_state();
  void show_triangles();
  void show_person();
  void show_naked_eye();

  Workbench& bench_;
  HumanPresenter& presenter_;
  PersonPresenter& person_;
  MeasurePresenter& measured_;
  NakedEyePresenter* naked_eye_;
  PlanAdvice* viewing_;
  QFormLayout* form_ = nullptr;
  PictureView* picture_;
  AlternativesPanel* alternatives_;
  LimitsPanel* limits_;
  PersonFields* fields_ = nullptr;
  QComboBox *question_, *set_, *air_, *criterion_, *axis_;
  QLineEdit *ranges_, *frequencies_, *contrasts_, *noise_, *packages_;
  QLabel *title_, *hint_;
  QSpinBox *per_size_, *shown_ms_;
  QCheckBox *limited_, *twin_;
  QPushButton *begin_, *abort_, *propose_;
  QLabel *progress_, *result_, *proposal_;
};

}  // namespace todbench
