// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/views/human_view.h"

#include <QCheckBox>
#include <QComboBox>
#include <QFormLayout>
#include <QHBoxLayout>
#include <QKeyEvent>
#include <QLineEdit>
#include <QSpinBox>
#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "bench/gui/presenters/human_presenter.h"
#include "bench/gui/presenters/measure_presenter.h"
#include "bench/gui/presenters/naked_eye_presenter.h"
#include "bench/gui/presenters/person_presenter.h"
#include "bench/gui/presenters/plan_advice.h"
#include "bench/gui/presenters/text_of.h"
#include "bench/gui/views/alternatives_panel.h"
#include "bench/gui/views/human_results.h"
#include "bench/gui/views/layout_pieces.h"
#include "bench/gui/views/limits_panel.h"
#include "bench/gui/views/person_fields.h"
#include "bench/gui/views/picture_view.h"
#include "bench/plan/atmospheres.h"
#include "bench/plan/resources.h"

namespace todbench {
namespace {

/// Questions of the page, in the order of the list.
constexpr int of_triangles = 0, of_set = 1, of_bars = 2, of_naked_eye = 3, of_blind = 4;

/// Parses "400, 800"; empty if a part is not a number.
std::optional<std::vector<double>> numbers_of(const QString& text) {
  std::vector<double> numbers;
  for (const QString& part : text.split(',', Qt::SkipEmptyParts)) {
    bool good = false;
    numbers.push_back(part.trimmed().toDouble(&good));
    if (!good) return std::nullopt;
  }
  return numbers;
}

constexpr std::array criteria_of_bars{BarCriterion::four_or_five, BarCriterion::bars_resolved, BarCriterion::detection};

QString question_title(BarCriterion criterion) {
  switch (criterion) {
    case BarCriterion::bars_resolved:
      return "Are there four bars?";
    case BarCriterion::detection:
      return "Where are the bars?";
    case BarCriterion::four_or_five:
      break;
  }
  return "Which one has four bars?";
}

}  // namespace

HumanView::HumanView(Workbench& bench, HumanPresenter& presenter, PersonPresenter& person, MeasurePresenter& measured,
                     QWidget* parent)
    : QWidget(parent),
      bench_(bench),
      presenter_(presenter),
      person_(person),
      measured_(measured),
      naked_eye_(new NakedEyePresenter(this)),
      viewing_(new PlanAdvice(viewing_advice, "Zooms and distances are compared.", this)) {
  setFocusPolicy(Qt::StrongFocus);
  auto* layout = new QHBoxLayout(this);
  auto* seen = new QVBoxLayout;
  picture_ = new PictureView;
  picture_->setObjectName("humanPicture");
  picture_->setFocusPolicy(Qt::NoFocus);
  picture_->setToolTip({});
  seen->addWidget(picture_, 1);
  alternatives_ = new AlternativesPanel;
  seen->addWidget(alternatives_, 0, Qt::AlignHCenter);
  seen->addWidget(limits_ = new LimitsPanel(bench));
  layout->addLayout(seen, 1);
  layout->addWidget(side_panel());
  connect(question_, &QComboBox::currentIndexChanged, this, &HumanView::show_question);
  connect(criterion_, &QComboBox::currentIndexChanged, this, &HumanView::show_question);
  connect(limited_, &QCheckBox::toggled, shown_ms_, &QWidget::setEnabled);
  connect(begin_, &QPushButton::clicked, this, &HumanView::begin);
  connect(abort_, &QPushButton::clicked, &presenter_, &HumanPresenter::abort);
  connect(abort_, &QPushButton::clicked, &person_, &PersonPresenter::abort);
  connect(alternatives_, &AlternativesPanel::chosen, &person_,
          [this](int alternative) { person_.answer(static_cast<std::size_t>(alternative)); });
  connect(&presenter_, &HumanPresenter::updated, this, &HumanView::show_state);
  connect(&person_, &PersonPresenter::updated, this, &HumanView::show_state);
  connect(abort_, &QPushButton::clicked, naked_eye_, &NakedEyePresenter::abort);
  connect(naked_eye_, &NakedEyePresenter::updated, this, &HumanView::show_state);
  connect(propose_, &QPushButton::clicked, viewing_, [this] { viewing_->ask(bench_.plan()); });
  connect(viewing_, &PlanAdvice::updated, proposal_, [this] { proposal_->setText(viewing_->words()); });
  connect(&measured_, &MeasurePresenter::state_changed, this, &HumanView::show_state);
  show_question();
}

QWidget* HumanView::side_panel() {
  auto* panel = new QWidget;
  panel->setFixedWidth(290);
  auto* side = new QVBoxLayout(panel);
  side->setContentsMargins(0, 0, 0, 0);
  side->addWidget(title_ = title_label({}));
  side->addWidget(hint_ = hint_label());
  auto* form = form_ = new QFormLayout;
  add_questions(*form);
  per_size_ = new QSpinBox;
  per_size_->setObjectName("humanPerSize");
  per_size_->setRange(1, 200);
  per_size_->setValue(8);
  limited_ = new QCheckBox("Limited time");
  shown_ms_ = new QSpinBox;
  shown_ms_->setRange(50, 10000);
  shown_ms_->setValue(1000);
  shown_ms_->setSuffix(" ms");
  shown_ms_->setAccessibleName("Display time of a patch");
  shown_ms_->setEnabled(false);
  form->setVerticalSpacing(3);
  fields_ = new PersonFields(*form, this);
  add_proposal(*form);
  form->addRow("Repetitions", per_size_);
  form->addRow(limited_, shown_ms_);
  side->addLayout(form);
  begin_ = primary_button("Begin", "beginHuman");
  abort_ = plain_button("End now", "endHuman");
  for (QPushButton* button : {begin_, abort_}) {
    button->setFocusPolicy(Qt::TabFocus);
    side->addWidget(button);
  }
  progress_ = new QLabel;
  progress_->setObjectName("humanProgress");
  progress_->setWordWrap(true);
  side->addWidget(progress_);
  result_ = new QLabel;
  result_->setObjectName("humanResult");
  result_->setWordWrap(true);
  result_->setTextFormat(Qt::RichText);
  side->addWidget(result_);
  side->addStretch();
  return panel;
}

void HumanView::add_proposal(QFormLayout& form) {
  propose_ = plain_button("Propose zoom and distance", "proposeViewing");
  propose_->setFocusPolicy(Qt::TabFocus);
  propose_->setToolTip("At which size of the picture display and eye cost less than 1 % of acuity, by hvs-2");
  form.addRow(propose_);
  proposal_ = hint_label();
  proposal_->setObjectName("viewingProposal");
  form.addRow(proposal_);
}

void HumanView::add_questions(QFormLayout& form) {
  question_ = new QComboBox;
  question_->setObjectName("humanQuestion");
  question_->addItems({"Triangles of the run", "Targets of a set", "Four bars", "Naked eye", "Several sources, blind"});
  set_ = new QComboBox;
  set_->setObjectName("humanSet");
  for (const auto& name : resource_names(ResourceKind::target_set)) set_->addItem(QString::fromStdString(name));
  set_->setCurrentText("small-craft");
  ranges_ = new QLineEdit("400, 800, 1600");
  ranges_->setObjectName("humanRanges");
  air_ = new QComboBox;
  air_->setObjectName("humanAir");
  for (const auto& name : atmosphere_names()) {
    // Needs a coefficient, which this page does not ask for.
    if (name != "beer-lambert") air_->addItem(QString::fromStdString(name));
  }
  criterion_ = new QComboBox;
  criterion_->setObjectName("humanCriterion");
  for (const BarCriterion criterion : criteria_of_bars) criterion_->addItem(text_of(to_string(criterion)));
  frequencies_ = new QLineEdit("0.3, 0.6, 0.9");
  frequencies_->setObjectName("humanFrequencies");
  contrasts_ = new QLineEdit("0.4, 0.15, 0.06");
  contrasts_->setObjectName("humanContrasts");
  contrasts_->setToolTip("Luminance contrasts of the triangles, brighter than the background");
  noise_ = new QLineEdit("0");
  noise_->setObjectName("humanNoise");
  noise_->setToolTip("Standard deviation of white noise per displayed sample, as a luminance contrast");
  axis_ = new QComboBox;
  axis_->setObjectName("humanAxis");
  axis_->addItems({"horizontal", "vertical"});
  packages_ = new QLineEdit;
  packages_->setObjectName("humanPackages");
  packages_->setPlaceholderText("files");
  packages_->setToolTip("Files of enhancement packages, separated by commas; each is a source beside the camera");
  twin_ = new QCheckBox("Simulated twin");
  twin_->setObjectName("humanTwin");
  twin_->setChecked(true);
  form.addRow("Question", question_);
  form.addRow("Packages", packages_);
  form.addRow(twin_);
  form.addRow("Target set", set_);
  form.addRow("Ranges (m)", ranges_);
  form.addRow("Atmosphere", air_);
  form.addRow("Criterion", criterion_);
  form.addRow("f / Nyquist", frequencies_);
  form.addRow("Axis", axis_);
  form.addRow("Contrasts", contrasts_);
  form.addRow("Noise", noise_);
}

BarCriterion HumanView::criterion() const {
  return criteria_of_bars[static_cast<std::size_t>(std::max(0, criterion_->currentIndex()))];
}

bool HumanView::triangles() const {
  return question_->currentIndex() != of_set && question_->currentIndex() != of_bars;
}

bool HumanView::of_frames() const {
  return question_->currentIndex() == of_triangles || question_->currentIndex() == of_blind;
}

void HumanView::show_question() {
  const int question = question_->currentIndex();
  form_->setRowVisible(set_, question == of_set);
  form_->setRowVisible(ranges_, question == of_set);
  form_->setRowVisible(air_, question == of_set);
  form_->setRowVisible(criterion_, question == of_bars);
  form_->setRowVisible(frequencies_, question == of_bars);
  form_->setRowVisible(axis_, question == of_bars);
  form_->setRowVisible(packages_, question == of_blind);
  form_->setRowVisible(twin_, question == of_blind);
  form_->setRowVisible(contrasts_, question == of_naked_eye);
  form_->setRowVisible(noise_, question == of_naked_eye);
  fields_->set_training_visible(of_frames());
  form_->setRowVisible(propose_, triangles());
  form_->setRowVisible(proposal_, triangles());
  title_->setText(question == of_set    ? "Which one is it?"
                  : question == of_bars ? question_title(criterion())
                                        : "Which way does it point?");
  const QString keys = question == of_set    ? "Press the key of an icon, or click the icon."
                       : question == of_bars ? "Answer with the left or right arrow key, or click."
                                             : "Answer with the arrow keys.";
  const bool yes_or_no = question == of_bars && criterion() == BarCriterion::bars_resolved;
  hint_->setText(
      keys +
      (yes_or_no ? " Left: four separate bars. Some frames have no bars. Answers that count get no feedback. "
                 : " Answers that count get no feedback. If you are not sure, guess. ") +
      (question == of_naked_eye ? "No camera is used: the triangles are drawn on this display, as its section "
                                  "[display] in the plan describes it."
       : question == of_blind   ? "Camera, twin and packages are mixed, and the page does not tell which is "
                                  "shown. The recorded frames are replayed first."
       : triangles()            ? "You judge the camera's own frames. The answers of the model are not shown."
                                : "You judge the same frames of the plan's simulated sensor as the model "
                                  "observer."));
  per_size_->setToolTip(question == of_set    ? "Frames per target and range"
                        : question == of_bars ? "Questions per contrast and frequency"
                                              : "Patches per contrast and size");
  show_state();
}

void HumanView::begin() {
  const auto facts = fields_->facts();
  if (!facts) {
    emit bench_.trouble(QString::fromStdString(facts.error().message), Remedy::none);
    return;
  }
  if (question_->currentIndex() == of_naked_eye) {
    begin_naked_eye(*facts);
    return;
  }
  if (!triangles()) {
    begin_person(*facts);
    return;
  }
  HumanOptions options;
  options.person = *facts;
  options.training = fields_->training();
  options.per_size = per_size_->value();
  if (limited_->isChecked()) options.shown_ms = shown_ms_->value();
  options.seed = bench_.plan().seed;
  if (question_->currentIndex() == of_blind) {
    std::vector<std::string> packages;
    for (const QString& file : packages_->text().split(',', Qt::SkipEmptyParts))
      packages.push_back(file.trimmed().toStdString());
    const QString wrong =
        presenter_.begin_blind(measured_.judged_session(), packages, twin_->isChecked(), bench_.plan(),
                               new_person_folder(bench_.sessions_folder(), "blind"), options);
    if (!wrong.isEmpty()) emit bench_.trouble(wrong, Remedy::none);
    setFocus();
    return;
  }
  const QString problem = presenter_.begin(measured_.trials(), bench_.plan(), measured_.judged_session(), options);
  if (!problem.isEmpty()) emit bench_.trouble(problem, Remedy::none);
  setFocus();
}

void HumanView::begin_person(const PersonFacts& facts) {
  PersonQuestion question{.task = question_->currentIndex() == of_set ? PersonTask::identify : PersonTask::bars,
                          .sensor = bench_.plan().simulation.sensor,
                          .set = set_->currentText().toStdString(),
                          .atmosphere = air_->currentText().toStdString(),
                          .axis = axis_->currentIndex() == 0 ? BarAxis::horizontal : BarAxis::vertical,
                          .criterion = criterion(),
                          .each = per_size_->value(),
                          .seed = bench_.plan().seed};
  const auto ranges = numbers_of(ranges_->text()), frequencies = numbers_of(frequencies_->text());
  if (!ranges || !frequencies) {
    emit bench_.trouble("Enter ranges and frequencies as numbers separated by commas, for example 400, 800.",
                        Remedy::none);
    return;
  }
  question.ranges_m = *ranges;
  question.of_nyquist = *frequencies;
  auto experiment = person_experiment(question);
  if (!experiment) {
    emit bench_.trouble(QString::fromStdString(experiment.error().message), Remedy::none);
    return;
  }
  alternatives_->set_alternatives(*experiment);
  person_.begin(*std::move(experiment), facts, bench_.sessions_folder(),
                limited_->isChecked() ? std::optional(shown_ms_->value()) : std::nullopt);
  setFocus();
}

void HumanView::begin_naked_eye(const PersonFacts& facts) {
  const auto contrasts = numbers_of(contrasts_->text()), noise = numbers_of(noise_->text());
  if (!contrasts || !noise || noise->size() != 1) {
    emit bench_.trouble(
        "Enter contrasts as numbers separated by commas, for example 0.4, 0.1, and one number as noise.", Remedy::none);
    return;
  }
  const QString problem = naked_eye_->begin(
      bench_.plan(),
      {.contrasts = *contrasts, .noise = noise->front(), .per_size = per_size_->value(), .person = facts},
      bench_.sessions_folder(), limited_->isChecked() ? std::optional(shown_ms_->value()) : std::nullopt);
  if (!problem.isEmpty()) emit bench_.trouble(problem, Remedy::none);
  setFocus();
}

void HumanView::keyPressEvent(QKeyEvent* event) {
  if (!triangles()) {
    const int alternative = alternatives_->of_key(event->key());
    if (alternative < 0) {
      QWidget::keyPressEvent(event);
      return;
    }
    person_.answer(static_cast<std::size_t>(alternative));
    return;
  }
  constexpr std::array arrows{std::pair(Qt::Key_Up, Apex::up), std::pair(Qt::Key_Right, Apex::right),
                              std::pair(Qt::Key_Down, Apex::down), std::pair(Qt::Key_Left, Apex::left)};
  const auto arrow = std::ranges::find(arrows, event->key(), [](const auto& one) { return int{one.first}; });
  if (arrow == arrows.end())
    QWidget::keyPressEvent(event);
  else if (question_->currentIndex() == of_naked_eye)
    naked_eye_->answer(arrow->second);
  else
    presenter_.answer(arrow->second);
}

void HumanView::show_state() {
  const auto running = [](HumanState state) { return state == HumanState::showing || state == HumanState::hidden; };
  question_->setEnabled(!running(presenter_.state()) && !running(person_.state()) && !running(naked_eye_->state()) &&
                        !naked_eye_->predicting() && !presenter_.preparing());
  criterion_->setEnabled(question_->isEnabled());
  alternatives_->setVisible(!triangles() && running(person_.state()));
  limits_->set_replayed_plan(measured_.replayed_plan());
  limits_->setVisible(of_frames() && !running(presenter_.state()) && !presenter_.preparing());
  if (question_->currentIndex() == of_naked_eye)
    show_naked_eye();
  else if (triangles())
    show_triangles();
  else
    show_person();
}

void HumanView::show_person() {
  const HumanState state = person_.state();
  const bool running = state == HumanState::showing || state == HumanState::hidden;
  begin_->setEnabled(!running);
  abort_->setEnabled(running);
  picture_->set_placeholder(state == HumanState::hidden ? "Which one was it?"
                            : running                   ? ""
                                                        : "Press Begin when you are ready.");
  picture_->set_surround(QColor(128, 128, 128));
  picture_->set_image(state == HumanState::showing ? person_.picture() : QImage());
  picture_->set_zoom(1);
  const auto& experiment = person_.experiment();
  progress_->setText(running ? QString("%1 of %2").arg(person_.answers().size()).arg(experiment->trials().size())
                             : QString());
  const bool of_this =
      experiment && (experiment->task() == PersonTask::identify) == (question_->currentIndex() == of_set);
  if (state != HumanState::finished || !of_this) {
    result_->setText({});
    return;
  }
  result_->setText(result_of_a_person(person_));
}

void HumanView::show_naked_eye() {
  const HumanState state = naked_eye_->state();
  const bool running = state == HumanState::showing || state == HumanState::hidden;
  begin_->setEnabled(!running && !naked_eye_->predicting());
  abort_->setEnabled(running || naked_eye_->predicting());
  picture_->set_placeholder(naked_eye_->predicting()      ? "The model predicts your answers."
                            : state == HumanState::hidden ? "Which way did it point?"
                            : running                     ? ""
                                                          : "Press Begin when you are ready.");
  const int level = naked_eye_->background_level();
  picture_->set_surround(QColor(level, level, level));
  picture_->set_image(state == HumanState::showing ? naked_eye_->picture() : QImage());
  // Pixels of the screen, whatever its scale factor.
  picture_->set_zoom(1 / devicePixelRatioF());
  const auto& session = naked_eye_->session();
  progress_->setText(running ? QString("%1 of %2").arg(session->done()).arg(session->planned()) : QString());
  if (state != HumanState::finished || !naked_eye_->problem().isEmpty()) {
    result_->setText(naked_eye_->problem());
    return;
  }
  result_->setText(result_of_naked_eye(*naked_eye_));
}

void HumanView::show_triangles() {
  const HumanState state = presenter_.state();
  const bool running = state == HumanState::showing || state == HumanState::hidden;
  const bool ready = measured_.state() == RunState::idle && measured_.outcome() && !measured_.trials().empty();
  begin_->setEnabled(ready && !running && !presenter_.preparing());
  abort_->setEnabled(running || presenter_.preparing());
  picture_->set_placeholder(presenter_.preparing()        ? "The recorded frames are replayed for each source."
                            : state == HumanState::hidden ? "Which way did it point?"
                            : running                     ? ""
                            : ready                       ? "Press Begin when you are ready."
                                    : "Run a measurement first, or open a session with recorded frames and press "
                                      "Replay. A person then judges its frames.");
  const int level = presenter_.background_level();
  picture_->set_surround(QColor(level, level, level));
  // A fixed number of screen pixels per sample: the size of the window does not affect the picture.
  picture_->set_image(state == HumanState::showing ? presenter_.picture() : QImage());
  picture_->set_zoom(presenter_.at_display() ? 1 / devicePixelRatioF() : 1);
  const QString count = presenter_.training_left() > 0
                            ? QString("Training: %1 to go").arg(presenter_.training_left())
                            : QString("%1 of %2").arg(presenter_.done()).arg(presenter_.planned());
  progress_->setText(!running                          ? QString()
                     : presenter_.feedback().isEmpty() ? count
                                                       : presenter_.feedback() + "\n" + count);
  if (presenter_.blind_result() && !running) {
    result_->setText(result_of_sources(presenter_));
    return;
  }
  if (!presenter_.record() || running) {
    result_->setText(presenter_.problem());
    return;
  }
  result_->setText(result_of_triangles(presenter_, measured_));
}

}  // namespace todbench
