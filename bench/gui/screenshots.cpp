// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/screenshots.h"

#include <QApplication>
#include <QComboBox>
#include <QElapsedTimer>
#include <QEventLoop>
#include <QPushButton>
#include <QSpinBox>
#include <QTimer>
#include <cstdio>
#include <functional>
#include <utility>

#include "bench/gui/presenters/naked_eye_presenter.h"
#include "bench/gui/views/page_check.h"

namespace todbench {
namespace {

/// Runs the event loop until the condition holds; false after two minutes.
bool wait_until(const std::function<bool()>& so) {
  QElapsedTimer waited;
  waited.start();
  while (!so() && waited.elapsed() < 120'000) {
    QApplication::processEvents(QEventLoop::AllEvents, 20);
    QEventLoop loop;
    QTimer::singleShot(10, &loop, &QEventLoop::quit);
    loop.exec();
  }
  return so();
}

/// Saves a page. Returns false, with a sentence on standard error for every fault of the page.
bool save(MainWindow& window, const std::filesystem::path& folder, const char* name) {
  QApplication::processEvents();
  QApplication::processEvents();
  const QStringList faults = faults_of(window);
  for (const QString& fault : faults) std::fprintf(stderr, "todbench-gui: page %s: %s\n", name, qPrintable(fault));
  const auto file = folder / (std::string(name) + ".png");
  const bool saved = window.grab().save(QString::fromStdString(file.string()));
  if (saved) std::printf("%s\n", file.string().c_str());
  return saved && faults.isEmpty();
}

/// Half of the answers per contrast, enough to draw curves.
Plan short_plan(Plan plan) {
  plan.target.phases = 4;
  plan.simulation.phases = 4;
  plan.target.mountings = {Mounting::identity, Mounting::rotated_180};
  return plan;
}

/// Simulates a person who gives the model's answers, with a picture after the fortieth.
bool answer_as_a_person(MainWindow& window, const std::filesystem::path& folder) {
  HumanPresenter& human = window.human();
  const auto patches = patches_for_a_person(window.measure().trials(), {});
  if (!human.begin(window.measure().trials(), window.bench().plan(), window.measure().folder(), {}).isEmpty())
    return false;
  bool good = true;
  for (std::size_t i = 0; i < patches.size(); ++i) {
    if (i == 40) good &= save(window, folder, "human");
    human.answer(patches[i].trial.answer);
  }
  return good;
}

/// Simulates a person for targets and for bars, with a picture halfway through each.
bool ask_of_targets_and_bars(MainWindow& window, const std::filesystem::path& folder) {
  bool good = true;
  window.show_view(View::human);
  auto* question = window.findChild<QComboBox*>("humanQuestion");
  auto* each = window.findChild<QSpinBox*>("humanPerSize");
  each->setValue(2);
  for (const auto& [index, name] : {std::pair(1, "human-targets"), std::pair(2, "human-bars")}) {
    question->setCurrentIndex(index);
    window.findChild<QPushButton*>("beginHuman")->click();
    const PersonPresenter& person = window.person();
    if (!person.experiment()) return false;
    for (std::size_t i = 0; i < person.experiment()->trials().size(); ++i) {
      if (i == 8) good &= save(window, folder, name);
      window.person().answer(person.experiment()->trials()[i].truth);
    }
  }
  question->setCurrentIndex(0);
  return good;
}

/// Shows one triangle to a simulated person before a display of a usual size.
bool ask_the_naked_eye(MainWindow& window, const std::filesystem::path& folder) {
  const Plan before = window.bench().plan();
  Plan plan = before;
  plan.display = {.pixel_pitch_mm = 0.27, .viewing_distance_m = 1.86, .luminance_white_cd_m2 = 200, .zoom = 2};
  window.bench().set_plan(plan);
  auto* question = window.findChild<QComboBox*>("humanQuestion");
  auto* eye = window.findChild<NakedEyePresenter*>();
  question->setCurrentIndex(3);
  window.findChild<QPushButton*>("beginHuman")->click();
  bool good = wait_until([&] { return eye->state() == HumanState::showing || !eye->problem().isEmpty(); });
  for (int i = 0; i < 40 && eye->state() == HumanState::showing; ++i) {
    if (i == 5) good &= save(window, folder, "human-naked-eye");
    eye->answer(eye->session()->trial().truth);
  }
  eye->abort();
  question->setCurrentIndex(0);
  window.bench().set_plan(before);
  return good;
}

int said(bool good) {
  if (!good) std::fprintf(stderr, "todbench-gui: at least one page has a fault or was not written\n");
  return good ? 0 : 7;
}

}  // namespace

int take_session_screenshots(MainWindow& window, const std::filesystem::path& folder,
                             const std::filesystem::path& session) {
  std::error_code problem;
  std::filesystem::create_directories(folder, problem);
  window.show();
  bool good = true;
  window.show_view(View::start);
  good &= save(window, folder, "start");
  window.show_view(View::plan);
  good &= wait_until([&] { return window.plan().expected_known() && !window.plan().prices().empty(); });
  good &= save(window, folder, "plan");
  good &= ask_of_targets_and_bars(window, folder);
  good &= ask_the_naked_eye(window, folder);
  window.open_path(session);
  window.show_view(View::report);
  good &= wait_until([&] { return window.sessions().current() && !window.sessions().sessions().empty(); });
  good &= save(window, folder, "report");
  window.history().add_sessions(window.bench().sessions_folder());
  window.show_view(View::history);
  good &= save(window, folder, "history");
  return said(good);
}

int take_screenshots(MainWindow& window, const std::filesystem::path& folder) {
  std::error_code problem;
  std::filesystem::create_directories(folder, problem);
  window.bench().set_plan(short_plan(window.bench().plan()));
  window.show();
  bool good = true;
  window.show_view(View::start);
  good &= save(window, folder, "start");
  window.show_view(View::look);
  window.look().start();
  good &= wait_until([&] { return window.look().latest() && window.look().latest()->counters.good > 60; });
  good &= save(window, folder, "look");
  window.show_view(View::align);
  window.align().start();
  good &= wait_until([&] { return window.align().looks() >= 3; });
  good &= save(window, folder, "align");
  window.bench().stop();
  window.show_view(View::plan);
  good &= wait_until([&] { return window.plan().expected_known() && !window.plan().prices().empty(); });
  good &= save(window, folder, "plan");
  window.show_view(View::measure);
  window.measure().start();
  good &= wait_until([&] { return window.measure().twin() && window.measure().twin()->points.size() > 1; });
  good &= save(window, folder, "measure");
  good &= wait_until([&] { return window.measure().state() == RunState::idle; });
  good &= save(window, folder, "measured");
  good &= wait_until([&] { return window.sessions().current().has_value(); });
  window.show_view(View::human);
  good &= answer_as_a_person(window, folder);
  window.show_view(View::chain);
  good &= wait_until([&] { return !window.chain().pictures().empty(); });
  good &= save(window, folder, "chain");
  auto* shown = window.findChild<QComboBox*>("chainScene");
  shown->setCurrentIndex(1);
  good &= wait_until([&] { return !window.chain().options().scene.empty() && !window.chain().busy(); });
  good &= save(window, folder, "chain-scene");
  shown->setCurrentIndex(0);
  window.show_view(View::report);
  good &= wait_until([&] { return window.sessions().current() && !window.sessions().sessions().empty(); });
  good &= save(window, folder, "report");
  return said(good);
}

}  // namespace todbench
