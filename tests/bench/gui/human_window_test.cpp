// SPDX-License-Identifier: GPL-3.0-or-later
// A person at the window, by synthetic keys.
#include <QComboBox>
#include <QLabel>
#include <QLineEdit>
#include <QSpinBox>
#include <algorithm>
#include <cmath>

#include "bench/gui/views/human_view.h"
#include "bench/gui/views/page_check.h"
#include "bench/gui/views/picture_view.h"
#include "bench/session/trials_csv.h"
#include "bench/text/files.h"
#include "bench/text/text.h"
#include "tests/bench/gui/gui_test_support.h"
#include "tests/support/verify_manifest.h"

namespace todbench::testing {
namespace {

using ::testing::HasSubstr;

TEST(HumanObserver, LeavesItsAnswersBesideTheModelsInTheSameSession) {
  ShownWindow window("sim:sc2000", 3);
  window.measure();
  window->show_view(View::human);
  window.part<QSpinBox>("humanPerSize").setValue(2);

  window.click("beginHuman");
  HumanView* view = window->findChild<HumanView*>();
  ASSERT_NE(view, nullptr);
  // 2 contrasts, 5 sizes, 2 of each.
  ASSERT_EQ(window->human().planned(), 20u);
  std::vector<Apex> pressed;
  for (std::size_t i = 0; i < 20; ++i) {
    EXPECT_FALSE(window.part<PictureView>("humanPicture").image().isNull());
    QTest::keyClick(view, answer_keys[i % 4]);
    pressed.push_back(all_apexes[i % 4]);
  }

  EXPECT_EQ(window->human().state(), HumanState::finished);
  EXPECT_EQ(window->human().problem().toStdString(), "");
  const auto folder = window->measure().folder();
  const auto answers = read_trials(folder / "trials_human.csv");
  ASSERT_TRUE(answers) << answers.error().message;
  ASSERT_EQ(answers->size(), 20u);
  for (std::size_t i = 0; i < 20; ++i) EXPECT_EQ((*answers)[i].answer, pressed[i]);
  const auto record = read_human(folder);
  ASSERT_TRUE(record && *record) << (record ? "" : record.error().message);
  EXPECT_EQ((*record)->curve.observer, "human");
  ASSERT_TRUE(wait_until([&] { return !window.part<QLabel>("exportedFiles").text().isEmpty(); }))
      << "report, PDF and manifest are made again";
  const auto changed = verify_manifest(folder);
  ASSERT_TRUE(changed) << changed.error().message;
  EXPECT_THAT(*changed, ::testing::IsEmpty());
  EXPECT_TRUE(wait_until([&] { return window->sessions().current() && window->sessions().current()->human; }));
  EXPECT_EQ(faults_at_three_sizes(*window), "");
}

TEST(HumanObserver, JudgesSeveralSourcesBlindInOneMixedOrder) {
  ShownWindow window("sim:sc2000", 3);
  Plan plan = window->bench().plan();
  plan.measurement.record_frames = true;
  window->bench().set_plan(plan);
  window.measure();
  const auto session = window->measure().folder();
  const std::string before = read_text_file(session / "manifest.json").value();
  const auto package = window.sessions() / "fine.toml";
  ASSERT_TRUE(write_file_atomically(package, "name = \"sharp\"\n[[stage]]\nkind = \"sharpen\"\namount = 1\n"));
  window->show_view(View::human);
  window.part<QComboBox>("humanQuestion").setCurrentIndex(4);
  window.part<QLineEdit>("humanPackages").setText(QString::fromStdString(package.string()));
  window.part<QSpinBox>("humanPerSize").setValue(4);

  window.click("beginHuman");
  HumanPresenter& human = window->human();
  ASSERT_TRUE(wait_until([&] { return human.state() == HumanState::showing || !human.problem().isEmpty(); }))
      << human.problem().toStdString();
  ASSERT_EQ(human.planned(), 3u * 2 * 5 * 4) << "camera, twin and package; 2 contrasts, 5 sizes, 4 of each";
  HumanView* view = window->findChild<HumanView*>();
  QStringList shown;
  while (human.state() == HumanState::showing) {
    for (const QLabel* label : view->findChildren<QLabel*>()) {
      if (label->isVisible()) shown << label->text();
    }
    EXPECT_THAT(faults_of(*window).join("; ").toStdString(), ::testing::Not(HasSubstr("cut off")));
    QTest::keyClick(view, Qt::Key_Up);
  }

  EXPECT_EQ(human.problem().toStdString(), "");
  const QString all = shown.join("\n");
  for (const char* source : {"sharp", "simulated"}) EXPECT_FALSE(all.contains(source)) << source;
  ASSERT_TRUE(human.blind_result());
  EXPECT_EQ(human.blind_result()->sources, (std::vector<std::string>{"camera", "simulated", "sharp"}));
  EXPECT_TRUE(std::filesystem::exists(human.folder() / "blind.json"));
  EXPECT_TRUE(window.part<QLabel>("humanResult").text().contains("sharp"));
  EXPECT_EQ(faults_at_three_sizes(*window), "");
  EXPECT_EQ(read_text_file(session / "manifest.json").value(), before) << "the recorded session does not change";
}

TEST(HumanObserver, KeepsWhatWasShownSoThatEveryAnswerCanBeChecked) {
  ShownWindow window("sim:sc2000", 3);
  window.measure();
  const auto judged = window->measure().trials();
  const auto folder = window->measure().folder();

  ASSERT_EQ(window->human().begin(judged, window->bench().plan(), folder, {.per_size = 2, .shown_ms = 5000, .seed = 3}),
            "");
  std::vector<QImage> seen;
  while (window->human().state() == HumanState::showing) {
    seen.push_back(window->human().picture());
    window->human().answer(Apex::up);
  }

  const auto record = read_human(folder);
  ASSERT_TRUE(record) << record.error().message;
  ASSERT_TRUE(*record);
  ASSERT_EQ((*record)->shown.size(), seen.size());
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const Trial& answered = (*record)->trials[i];
    const ShownPatch& shown = (*record)->shown[i];
    // The frame's own trial: the truth is that of the plate, and the samples are those that the model judged.
    const auto original = std::find_if(judged.begin(), judged.end(), [&](const JudgedTrial& j) {
      return j.trial.presentation == answered.presentation && j.trial.triangle == answered.triangle;
    });
    ASSERT_NE(original, judged.end());
    EXPECT_EQ(answered.truth, original->trial.truth);
    EXPECT_EQ(answered.frame, original->trial.frame);
    ASSERT_EQ(shown.kelvin.size(), original->patch_k.size());
    EXPECT_EQ(cv::norm(shown.kelvin, original->patch_k, cv::NORM_INF), 0);
    EXPECT_EQ(shown.limit_ms, std::optional(5000));
    EXPECT_GE(shown.response_s, 0);
    // What is on disk makes the picture that was seen.
    const JudgedTrial again{.curve = SessionCurve::main, .trial = answered, .patch_k = shown.kelvin};
    EXPECT_EQ(grey_levels(again).low, shown.black_k);
    EXPECT_EQ(grey_levels(again).high, shown.white_k);
    EXPECT_EQ(picture_for_a_person(again, shown.magnification), seen[i]);
  }
}

TEST(HumanObserver, SeesThePictureOfAnOperatorAtTheDisplayOfThePlan) {
  ShownWindow window("sim:sc2000", 1);
  Plan plan = window->bench().plan();
  plan.display = {.pixel_pitch_mm = 0.25, .viewing_distance_m = 0.6, .luminance_white_cd_m2 = 180, .zoom = 4};
  window->bench().set_plan(plan);
  window.measure();
  window->show_view(View::human);
  window.click("beginHuman");

  const JudgedTrial judged =
      patches_for_a_person(window->measure().trials(), {.per_size = 8, .shown_ms = {}, .seed = plan.seed}).front();
  const QImage& shown = window.part<PictureView>("humanPicture").image();
  EXPECT_EQ(shown.width(), 4 * judged.patch_k.cols);
  EXPECT_EQ(shown, picture_at_display(judged, plan.display));
  window->human().answer(Apex::up);
  window.click("endHuman");

  const auto record = read_human(window->measure().folder());
  ASSERT_TRUE(record && *record);
  EXPECT_EQ((*record)->shown.front().magnification, 4);
  // Black and white are those of the levels: a full contrast is 0.5 of the background by default.
  EXPECT_NEAR((*record)->shown.front().white_k - (*record)->shown.front().black_k, 4 * std::abs(judged.trial.delta_t_k),
              1e-6);
}

TEST(HumanObserver, StandsInTheReportBesideTheModel) {
  ShownWindow window("sim:sc2000", 6);
  window.measure();
  const auto folder = window->measure().folder();
  ASSERT_EQ(window->human().begin(window->measure().trials(), window->bench().plan(), folder,
                                  {.per_size = 12, .shown_ms = {}, .seed = 3}),
            "");
  const auto chosen = patches_for_a_person(window->measure().trials(), {.per_size = 12, .shown_ms = {}, .seed = 3});

  // Someone who sees everything of 2 mrad and more, and says "up" to the rest.
  for (const auto& patch : chosen) window->human().answer(patch.trial.size_mrad > 2 ? patch.trial.truth : Apex::up);

  const auto opened = read_opened_session(folder);
  ASSERT_TRUE(opened) << opened.error().message;
  ASSERT_TRUE(opened->human && opened->report.human);
  for (const auto& point : opened->report.human->points) {
    for (const auto& level : point.levels) EXPECT_TRUE(level.size < 2 || level.correct == level.total);
  }
  const std::string page = render_report(opened->report);
  EXPECT_THAT(page, ::testing::HasSubstr("<h2>Human observer</h2>"));
  EXPECT_EQ(human_plots(opened->report).size(), 2u);
  EXPECT_EQ(human_plots(opened->report).front().series.empty(), false);
}

TEST(HumanObserver, KeepsEveryPersonWithFactsAndStatesTheirMean) {
  ShownWindow window("sim:sc2000", 6);
  window.measure();
  const auto folder = window->measure().folder();
  std::size_t judged = 0;
  const auto judge = [&](const std::string& code, double sees_mrad, std::optional<double> age) {
    HumanOptions options{.per_size = 12, .shown_ms = {}, .seed = 3};
    options.person.code = code;
    options.person.age_years = age;
    // While the report with the person before is written, the session takes no other one.
    ASSERT_TRUE(wait_until([&] {
      return window->human().begin(window->measure().trials(), window->bench().plan(), folder, options).isEmpty();
    }));
    const auto chosen = patches_for_a_person(window->measure().trials(), options);
    // Right in three of four answers from `sees_mrad` on, always from 1.6 times that on: no step, which has no
    // threshold.
    std::size_t number = 0;
    for (const auto& patch : chosen) {
      const bool sure = patch.trial.size_mrad > 1.6 * sees_mrad;
      const bool right = sure || (patch.trial.size_mrad > sees_mrad && ++number % 4 != 0);
      window->human().answer(right ? patch.trial.truth : all_apexes[number++ % 4]);
    }
    EXPECT_EQ(window->human().problem().toStdString(), "");
    ++judged;
    const std::string stated = code + (age ? ", " + std::to_string(static_cast<int>(*age)) + " years" : std::string());
    ASSERT_TRUE(wait_until([&] {
      const auto& current = window->sessions().current();
      const auto changed = verify_manifest(folder);
      return current && current->report.people.size() == judged && changed && changed->empty() &&
             content_of(folder / "report.html").find(stated) != std::string::npos;
    }));
  };

  judge("P1", 1.5, 34);
  judge("P2", 2.2, {});
  judge("P1", 1.5, 35);  // another day, a year later

  const auto people = read_people(folder);
  ASSERT_TRUE(people) << people.error().message;
  ASSERT_EQ(people->size(), 3u);
  EXPECT_EQ((*people)[0].person.code, "P1");
  EXPECT_EQ((*people)[0].person.age_years, std::optional(34.0));
  EXPECT_EQ((*people)[1].person.code, "P2");
  EXPECT_FALSE((*people)[1].person.age_years);
  EXPECT_NE((*people)[0].record.trials.size(), 0u);
  // A person counts once.
  const std::vector<PeopleMean> means = mean_over_people(*people);
  ASSERT_FALSE(means.empty());
  for (const PeopleMean& mean : means) EXPECT_LE(mean.people, 2);
  EXPECT_EQ(std::ranges::max(means, {}, &PeopleMean::people).people, 2);
  ASSERT_TRUE(wait_until([&] {
    return window->sessions().current() && window->sessions().current()->report.people.size() == 3 &&
           !window.part<QLabel>("exportedFiles").text().isEmpty();
  }));
  const std::string page = render_report(window->sessions().current()->report);
  EXPECT_THAT(page, ::testing::HasSubstr("P1, 34 years"));
  EXPECT_THAT(page, ::testing::HasSubstr(">mean of 2 people</text>"));
  ASSERT_TRUE(wait_until([&] {
    const auto changed = verify_manifest(folder);
    return changed && changed->empty();
  }));
}

TEST(HumanObserver, TrainsWithFeedbackBeforeAndGivesNoneDuringTheTest) {
  ShownWindow window("sim:sc2000", 3);
  window.measure();
  HumanOptions options{.per_size = 1, .shown_ms = {}, .seed = 3};
  options.training = 4;
  const auto training = patches_for_training(window->measure().trials(), options);
  ASSERT_EQ(training.size(), 4u);
  double largest = 0;
  for (const auto& judged : window->measure().trials()) largest = std::max(largest, judged.trial.size_mrad);
  for (const auto& patch : training) {
    EXPECT_EQ(patch.trial.set_delta_t_k, 16.9);
    EXPECT_NEAR(patch.trial.size_mrad, largest, 1e-6);
  }
  ASSERT_EQ(
      window->human().begin(window->measure().trials(), window->bench().plan(), window->measure().folder(), options),
      "");

  window->show_view(View::human);
  window->human().answer(training[0].trial.truth);
  EXPECT_TRUE(window->human().feedback().startsWith("✓"));
  EXPECT_EQ(faults_at_three_sizes(*window), "");
  window->human().answer(training[1].trial.truth == Apex::up ? Apex::down : Apex::up);
  EXPECT_TRUE(window->human().feedback().startsWith("✗"));
  window->human().answer(Apex::up);
  window->human().answer(Apex::up);
  EXPECT_EQ(window->human().training_left(), 0u);
  EXPECT_EQ(window->human().done(), 0u) << "the training does not count";
  while (window->human().state() == HumanState::showing) {
    window->human().answer(Apex::up);
    EXPECT_EQ(window->human().feedback().toStdString(), "");
  }
  const auto people = read_people(window->measure().folder());
  ASSERT_TRUE(people && people->size() == 1);
  EXPECT_EQ(people->front().person.training_answers, 4);
  EXPECT_EQ(people->front().record.trials.size(), window->human().planned());
}

TEST(HumanObserver, AddsToTheRecordedSessionOnAnotherDay) {
  ShownWindow window("sim:sc2000", 2);
  Plan plan = window->bench().plan();
  plan.measurement.record_frames = true;
  window->bench().set_plan(plan);
  window.measure();
  const auto recorded = window->measure().folder();
  ASSERT_TRUE(wait_until([&] { return window->sessions().current().has_value(); }));
  window->show_view(View::report);
  window.click("replaySession");
  ASSERT_TRUE(wait_until([&] { return window->measure().state() == RunState::idle; }));
  ASSERT_EQ(window->measure().same_as_recorded(), std::optional(true));

  plan.simulation.sensor = "no-such-sensor";
  window->bench().set_plan(plan);
  window->show_view(View::human);
  EXPECT_TRUE(wait_until([&] { return window.part<QLabel>("acuityLimits").text().contains("of sc2000 for"); }))
      << "limits of the session's sensor";
  window.part<QLineEdit>("personCode").setText("P7");
  window.part<QSpinBox>("humanPerSize").setValue(1);
  window.click("beginHuman");
  while (window->human().state() == HumanState::showing) window->human().answer(Apex::up);

  const auto people = read_people(recorded);
  ASSERT_TRUE(people && people->size() == 1) << "the answers belong to the recorded session, not to its replay";
  EXPECT_EQ(people->front().person.code, "P7");
}

TEST(MeanOverPeople, HasAnIntervalThatContainsTheScatterBetweenPeople) {
  const auto person = [](const char* code, double s75_mrad) {
    PersonRecord out;
    out.person.code = code;
    TodPoint point;
    point.set_delta_t_k = 1;
    point.fit.threshold = s75_mrad;
    point.fit.verdict = FitVerdict::ok;
    point.fit.ci95 = {0.9 * s75_mrad, 1.1 * s75_mrad};
    out.record.curve.points.push_back(point);
    return out;
  };
  PersonRecord guesses = person("D", 7e8);
  guesses.record.curve.points.front().fit.verdict = FitVerdict::extrapolated;
  guesses.record.curve.points.front().fit.ci95 = {4, {}};

  const auto one = mean_over_people({person("A", 2)});
  const auto three = mean_over_people({person("A", 1), person("B", 2), person("C", 4), person("C", 4), guesses});

  ASSERT_EQ(one.size(), 1u);
  EXPECT_FALSE(one.front().ci95_mrad) << "one person has no scatter";
  ASSERT_EQ(three.size(), 1u);
  EXPECT_EQ(three.front().people, 3) << "answers at chance have no threshold";
  EXPECT_NEAR(three.front().s75_mrad, 2, 1e-12);
  // ln S75 = 0, ln 2, ln 4: standard deviation ln 2; t(0.975, 2) = 4.302653 (tables of Student's t).
  const double factor = std::exp(4.302653 * std::log(2.0) / std::sqrt(3.0));
  EXPECT_NEAR(three.front().ci95_mrad->second, 2 * factor, 1e-4);
  EXPECT_NEAR(three.front().ci95_mrad->first, 2 / factor, 1e-5);
}

TEST(HumanObserver, SeesThePatchesOfTheCameraInRandomOrderAndNothingElse) {
  ShownWindow window("sim:sc2000", 2);
  window.measure();
  const auto& trials = window->measure().trials();

  const auto once = patches_for_a_person(trials, {.per_size = 4, .shown_ms = {}, .seed = 1});
  const auto again = patches_for_a_person(trials, {.per_size = 4, .shown_ms = {}, .seed = 1});
  const auto other = patches_for_a_person(trials, {.per_size = 4, .shown_ms = {}, .seed = 2});

  ASSERT_EQ(once.size(), 40u);
  const auto order = [](const std::vector<JudgedTrial>& patches) {
    std::vector<std::pair<std::int64_t, std::string>> out;
    for (const auto& p : patches) out.emplace_back(p.trial.presentation, p.trial.triangle);
    return out;
  };
  EXPECT_EQ(order(once), order(again));
  EXPECT_NE(order(once), order(other));
  auto sorted = order(once);
  std::sort(sorted.begin(), sorted.end());
  EXPECT_EQ(std::unique(sorted.begin(), sorted.end()), sorted.end()) << "no patch twice";
}

TEST(HumanObserver, SeesTheSameGreyOfTheSurroundWhateverTheAnswer) {
  ShownWindow window("sim:sc2000", 1);
  window.measure();

  for (const auto& judged : window->measure().trials()) {
    const QImage picture = picture_for_a_person(judged, 4);
    EXPECT_EQ(picture.width(), 4 * judged.patch_k.cols);
    // The median of the patch is the middle of the grey scale; noise of 0.07 K moves a corner at the lowest contrast.
    if (judged.trial.delta_t_k < 10) continue;
    EXPECT_NEAR(qGray(picture.pixel(0, 0)), 128, 6);
  }
}

TEST(HumanObserver, HidesThePatchWhenItsTimeIsOverAndStillTakesTheAnswer) {
  ShownWindow window("sim:sc2000", 1);
  window.measure();

  ASSERT_EQ(window->human()
                .begin(window->measure().trials(), window->bench().plan(), window->measure().folder(),
                       {.per_size = 1, .shown_ms = 50, .seed = 1})
                .toStdString(),
            "");
  ASSERT_TRUE(wait_until([&] { return window->human().state() == HumanState::hidden; }));
  window->human().answer(Apex::left);

  EXPECT_EQ(window->human().done(), 1u);
}

}  // namespace
}  // namespace todbench::testing
