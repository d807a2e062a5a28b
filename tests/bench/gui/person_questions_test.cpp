// SPDX-License-Identifier: GPL-3.0-or-later
// Questions to a person that need no camera: targets of a set, bars, triangles of the display.
#include <QComboBox>
#include <QLabel>
#include <QLineEdit>
#include <QSpinBox>
#include <QToolButton>

#include "bench/gui/presenters/naked_eye_presenter.h"
#include "bench/gui/views/human_view.h"
#include "bench/gui/views/page_check.h"
#include "bench/gui/views/picture_view.h"
#include "bench/plan/descriptions.h"
#include "bench/plan/loaded_plan.h"
#include "bench/twin/acuity_limits.h"
#include "bench/twin/experiment_inputs.h"
#include "tests/bench/gui/gui_test_support.h"

namespace todbench::testing {
namespace {

using ::testing::HasSubstr;

/// Chooses the question of the page, and gives the answers of a robot.
void ask(ShownWindow& window, int question, const char* field, const QString& values) {
  window->show_view(View::human);
  window.part<QComboBox>("humanQuestion").setCurrentIndex(question);
  window.part<QLineEdit>(field).setText(values);
  window.part<QSpinBox>("humanPerSize").setValue(1);
  window.part<QLineEdit>("personCode").setText("P7");
}

TEST(HumanObserver, TellsTheTargetsOfASetApartByTheirIcons) {
  ShownWindow window("sim:sc2000", 1);
  ask(window, 1, "humanRanges", "300, 900");

  window.click("beginHuman");

  const auto& experiment = window->person().experiment();
  ASSERT_TRUE(experiment);
  ASSERT_EQ(experiment->trials().size(), 24u);
  HumanView* view = window->findChild<HumanView*>();
  std::vector<std::size_t> given;
  for (std::size_t i = 0; i < 24; ++i) {
    EXPECT_FALSE(window.part<PictureView>("humanPicture").image().isNull());
    const std::size_t answer = experiment->trials()[i].truth;
    // By turns with the mouse and with the key that stands below the icon.
    if (i % 2 == 0)
      QTest::mouseClick(&window.part<QToolButton>(("alternative" + std::to_string(answer)).c_str()), Qt::LeftButton);
    else
      QTest::keyClick(view, answer < 9 ? Qt::Key(Qt::Key_1 + answer) : Qt::Key(Qt::Key_A + answer - 9));
    given.push_back(answer);
  }

  EXPECT_EQ(window->person().state(), HumanState::finished);
  ASSERT_EQ(window->person().answers().size(), 24u);
  for (std::size_t i = 0; i < 24; ++i) EXPECT_EQ(window->person().answers()[i].answer, given[i]);
  EXPECT_EQ(window->person().problem().toStdString(), "");
  const Json stored = Json::parse(content_of(window->person().folder() / "person.json"));
  EXPECT_EQ(stored["person"]["code"], "P7");
  EXPECT_EQ(stored["person"]["judged_utc"].get<std::string>().size(), 20u);
  EXPECT_TRUE(std::filesystem::exists(window->person().folder() / "answers.csv"));
  EXPECT_FALSE(window.part<QWidget>("alternatives").isVisible());
}

TEST(HumanObserver, SaysWhichIntervalHasFourBars) {
  ShownWindow window("sim:sc2000", 1);
  ask(window, 2, "humanFrequencies", "0.4");
  window.click("beginHuman");
  ASSERT_TRUE(window->person().experiment());
  ASSERT_EQ(window->person().experiment()->trials().size(), 6u);
  HumanView* view = window->findChild<HumanView*>();

  for (std::size_t i = 0; i < 6; ++i) QTest::keyClick(view, i % 3 == 0 ? Qt::Key_Left : Qt::Key_Right);

  EXPECT_EQ(window->person().state(), HumanState::finished);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(window->person().answers()[i].answer, i % 3 == 0 ? 0u : 1u);
  EXPECT_TRUE(std::filesystem::exists(window->person().folder() / "person.json"));
}

TEST(HumanObserver, PageProposesZoomAndDistance) {
  ShownWindow window("sim:sc2000", 1);
  ask(window, 3, "humanContrasts", "0.3");
  const auto said = [&] { return window.part<QLabel>("viewingProposal").text().toStdString(); };

  window.click("proposeViewing");
  EXPECT_TRUE(wait_until([&] { return said().find("no section [display]") != std::string::npos; })) << said();
  Plan plan = window->bench().plan();
  plan.display = {.pixel_pitch_mm = 0.27, .viewing_distance_m = 0.6, .luminance_white_cd_m2 = 200, .zoom = 1};
  window->bench().set_plan(plan);
  window.click("proposeViewing");

  EXPECT_TRUE(wait_until([&] { return said().starts_with("from "); })) << said();
  EXPECT_THAT(said(), ::testing::HasSubstr("stated: 1.5 arcmin"));
}

TEST(HumanObserver, PageStatesWhatLimitsTheAcuityBeforeTheFirstAnswer) {
  ShownWindow window("sim:sc2000", 1);
  Plan plan = window->bench().plan();
  plan.target.delta_t_k = {16.9};
  plan.limits = {};  // of other contrasts
  window->bench().set_plan(plan);
  const QLabel& limits = window.part<QLabel>("acuityLimits");
  const auto said = [&] { return limits.text().toStdString(); };
  const auto all_stated = [&] { return limits.text().contains("</table>"); };

  window->show_view(View::human);
  EXPECT_THAT(said(), HasSubstr("is being calculated"));
  EXPECT_TRUE(window.part<QPushButton>("stopLimits").isVisible());
  EXPECT_EQ(faults_at_three_sizes(*window), "");
  window.click("stopLimits");
  EXPECT_THAT(said(), HasSubstr("was stopped"));
  window.click("stopLimits");
  ASSERT_TRUE(wait_until(all_stated)) << said();
  EXPECT_FALSE(window.part<QPushButton>("stopLimits").isVisible());
  EXPECT_THAT(said(), HasSubstr("for hvs-1. There is no display"));
  EXPECT_EQ(limits.text().count("<b>"), 2) << "the heading and the largest cost: " << said();
  EXPECT_THAT(said(), HasSubstr("<th>observer"));
  EXPECT_THAT(said(), Not(HasSubstr("<th>eye"))) << "hvs-1 has none";
  EXPECT_EQ(limits.text().count("–"), 0);

  plan.display = {.pixel_pitch_mm = 0.27, .viewing_distance_m = 0.6, .luminance_white_cd_m2 = 200, .zoom = 1};
  window->bench().set_plan(plan);
  ASSERT_TRUE(wait_until([&] { return all_stated() && limits.text().contains("hvs-2"); })) << said();
  EXPECT_THAT(said(), HasSubstr("at the display of the plan (zoom 1, 0.6 m"));
  EXPECT_EQ(limits.text().count("–"), 0);
  EXPECT_EQ(faults_at_three_sizes(*window), "");
  // The table has the values of the function behind `plan` and `doctor`.
  const LoadedPlan loaded = LoadedPlan::load(plan).value();
  EffectPlanner planner;
  ExperimentInputs inputs = experiment_inputs(loaded, planner).value();
  inputs.observer = load_observer_at("hvs-2", plan.display).value();
  const auto stated = acuity_limits(plan, inputs, plan.target.delta_t_k, {}).value();
  ASSERT_EQ(stated.size(), 1u);
  for (const FactorCost& cost : stated[0].costs)
    EXPECT_THAT(said(), HasSubstr(std::to_string(std::lround(cost.percent)) + " %"));
  EXPECT_THAT(said(), HasSubstr("<b>" + std::to_string(std::lround(stated[0].costs.at(0).percent)) + " %</b>"));

  plan.observer = "no-such-observer";
  window->bench().set_plan(plan);
  EXPECT_TRUE(wait_until([&] { return limits.text().contains("no-such-observer"); })) << said();
  window.part<QComboBox>("humanQuestion").setCurrentIndex(3);
  EXPECT_FALSE(limits.isVisible()) << "the naked eye has no sensor";
}

TEST(HumanObserver, AnswersTrianglesOfTheDisplayWithoutACamera) {
  ShownWindow window("sim:sc2000", 1);
  ask(window, 3, "humanContrasts", "0.3");
  HumanView* view = window->findChild<HumanView*>();
  NakedEyePresenter* eye = window->findChild<NakedEyePresenter*>();
  ASSERT_NE(eye, nullptr);
  Plan plan = window->bench().plan();
  plan.display = {.pixel_pitch_mm = 0.27, .viewing_distance_m = 1.86, .luminance_white_cd_m2 = 200, .zoom = 2};
  window->bench().set_plan(plan);

  window.click("beginHuman");
  ASSERT_TRUE(wait_until([&] { return eye->state() == HumanState::showing; })) << eye->problem().toStdString();
  EXPECT_EQ(faults_of(*window).join("; ").toStdString(), "");
  const auto prediction = content_of(eye->folder() / naked_eye_name);
  std::vector<Apex> given;
  for (std::size_t i = 0; !eye->session()->complete(); ++i) {
    const QImage& shown = window.part<PictureView>("humanPicture").image();
    ASSERT_FALSE(shown.isNull());
    // A sample is a square of two by two pixels of the screen.
    EXPECT_EQ(shown.width(), 2 * eye->session()->picture().levels.cols);
    EXPECT_EQ(qGray(shown.pixel(0, 0)), qGray(shown.pixel(1, 1)));
    given.push_back(eye->session()->trial().truth);
    QTest::keyClick(view, answer_keys[static_cast<std::size_t>(given.back())]);
  }

  EXPECT_EQ(eye->state(), HumanState::finished);
  EXPECT_EQ(eye->problem().toStdString(), "");
  EXPECT_EQ(content_of(eye->folder() / naked_eye_name), prediction);
  const auto answers = read_trials(eye->folder() / "trials_human.csv");
  ASSERT_TRUE(answers) << answers.error().message;
  ASSERT_EQ(answers->size(), given.size());
  for (std::size_t i = 0; i < given.size(); ++i) EXPECT_EQ((*answers)[i].answer, given[i]);
  const auto people = read_people(eye->folder());
  ASSERT_TRUE(people && people->size() == 1);
  EXPECT_EQ(people->front().person.code, "P7");
  EXPECT_THAT(window.part<QLabel>("humanResult").text().toStdString(), ::testing::HasSubstr("predicted"));

  plan.display = {};
  window->bench().set_plan(plan);
  window.click("beginHuman");
  EXPECT_FALSE(eye->predicting());
  EXPECT_THAT(faults_of(*window).join("; ").toStdString(), ::testing::HasSubstr("no section [display]"));
}

TEST(HumanObserver, IsAskedByTheCriterionAndBehindTheAirOfThePage) {
  ShownWindow window("sim:sc2000", 1);
  window.part<QComboBox>("humanCriterion").setCurrentText("bars-resolved");
  ask(window, 2, "humanFrequencies", "0.4");
  EXPECT_TRUE(window.part<QComboBox>("humanCriterion").isVisible());
  EXPECT_FALSE(window.part<QComboBox>("humanAir").isVisible());
  window.click("beginHuman");
  ASSERT_TRUE(window->person().experiment());
  QCoreApplication::processEvents();
  EXPECT_EQ(faults_of(*window).join("; ").toStdString(), "");
  EXPECT_EQ(window->person().experiment()->criterion(), BarCriterion::bars_resolved);
  // A frame of every contrast, and one without bars beside each.
  EXPECT_EQ(window->person().experiment()->trials().size(), 12u);
  window.click("endHuman");

  window.part<QComboBox>("humanAir").setCurrentText("tropical");
  ask(window, 1, "humanRanges", "300, 900");
  window.click("beginHuman");
  ASSERT_TRUE(window->person().experiment());
  for (const PersonCondition& condition : window->person().experiment()->conditions())
    EXPECT_LT(condition.transmittance, 0.9);
  EXPECT_EQ(window->person().experiment()->description()["atmosphere"], "tropical");
}

TEST(HumanObserver, KeepsTheAnswersOfOneWhoEndsEarlyAndRefusesWhatIsNoRange) {
  ShownWindow window("sim:sc2000", 1);
  QString trouble;
  QObject::connect(&window->bench(), &Workbench::trouble, [&](const QString& sentence) { trouble = sentence; });
  ask(window, 1, "humanRanges", "near, far");
  window.click("beginHuman");
  EXPECT_FALSE(trouble.isEmpty());
  EXPECT_FALSE(window->person().experiment());
  ask(window, 1, "humanRanges", "300, 900");
  window.click("beginHuman");
  QTest::keyClick(window->findChild<HumanView*>(), Qt::Key_3);
  QTest::keyClick(window->findChild<HumanView*>(), Qt::Key_Z);  // no alternative

  window.click("endHuman");

  EXPECT_EQ(window->person().state(), HumanState::finished);
  ASSERT_EQ(window->person().answers().size(), 1u);
  EXPECT_EQ(window->person().answers()[0].answer, 2u);
  EXPECT_TRUE(std::filesystem::exists(window->person().folder() / "person.json"));
}

TEST(HumanObserver, HasNothingToJudgeBeforeAMeasurement) {
  ShownWindow window("sim:sc2000", 1);
  window->show_view(View::human);

  EXPECT_FALSE(window.part<QPushButton>("beginHuman").isEnabled());
}

}  // namespace
}  // namespace todbench::testing
