// SPDX-License-Identifier: GPL-3.0-or-later
// An observer fitted to people, as a user asks for it.
#include <gmock/gmock.h>

#include <functional>

#include "bench/plan/descriptions.h"
#include "bench/run/experiment.h"
#include "bench/session/human_record.h"
#include "bench/session/manifest.h"
#include "bench/text/files.h"
#include "hvs/observer/template_observer.h"
#include "tests/system/system_test_support.h"

namespace todbench::testing {
namespace {

using ::testing::HasSubstr;

/// A session of the simulated sensor, with a human run that a template observer of known parameters answered.
class ObserverFitCommand : public ::testing::Test {
 protected:
  /// Every fifth patch of a small session: 64.
  /// `change`: of the answer with this number, from 1 on.
  void answer(const std::string& name, const TemplateObserverSpec& person, std::uint64_t seed,
              const std::function<void(Trial&, std::size_t)>& change = {}) const {
    const auto plan = read_plan(folder_.write(name + ".toml", small_plan(16)).string());
    ASSERT_TRUE(plan) << plan.error().message;
    Plan own = plan->plan();
    own.seed = seed;
    std::vector<Trial> answers;
    std::vector<ShownPatch> shown;
    TemplateObserver observer(person, triangle_alternatives());
    std::uint64_t number = 0;
    ExperimentListener listener;
    listener.on_trial = [&](SessionCurve, const Trial& trial, const Patch& patch) {
      if (++number % 5 != 0) return;
      const auto prepared = *observer.prepare(trial.size_px, 1);
      ShownPatch kept{.kelvin = {}, .limit_ms = {}, .noise_k = patch.noise_k};
      patch.kelvin.convertTo(kept.kelvin, CV_32F);
      Trial answered = trial;
      answered.answer = static_cast<Apex>(
          prepared->choose(patch, trial.delta_t_k, RandomStream(seed, "person").sub(number)).alternative);
      answered.scores = {};
      if (change) change(answered, answers.size() + 1);
      answers.push_back(answered);
      shown.push_back(kept);
    };
    const auto done = simulate_plan(*plan->with(own), {.folder = at(name)}, listener, {});
    ASSERT_TRUE(done) << done.error().message;
    ASSERT_TRUE(add_person(at(name), {.person = {}, .record = human_record(answers, shown, own).value()}));
  }
  Ended run(const std::vector<std::string>& arguments) const {
    ChildOptions options;
    options.folder = folder_.path();
    return todbench(arguments, options);
  }
  std::filesystem::path at(const std::string& name) const { return folder_.path() / name; }

  TemporaryFolder folder_;
};

const std::vector<std::string> quick{"observer",     "fit", "a",       "--free", "blur_sigma_samples,internal_noise",
                                     "--replicates", "99",  "--draws", "48",     "--json"};

std::vector<std::string> with(std::vector<std::string> arguments, const std::vector<std::string>& more) {
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

TEST_F(ObserverFitCommand, WritesAnObserverThatPlansTakeWithTheHashesOfItsSessions) {
  const TemplateObserverSpec person{.name = "person", .blur_sigma_samples = 0.5, .internal_noise = 0.1};
  answer("a", person, 3);

  const Ended ended = run(with(quick, {"--out", "anna.toml"}));

  ASSERT_EQ(ended.code, 0) << ended.err;
  const Json json = one_object(ended);
  EXPECT_EQ(json["parameter_file"], "anna.toml");
  for (const auto& [key, truth] : {std::pair("blur_sigma_samples", 0.5), std::pair("internal_noise", 0.1)}) {
    // 64 answers say little; how often intervals hold the truth is what observer_fit_study asks.
    const Json& estimate = json["estimates"][key];
    EXPECT_GT(estimate["value"].get<double>(), truth / 4) << key;
    EXPECT_LT(estimate["value"].get<double>(), 4 * truth) << key;
    EXPECT_GT(estimate["value"].get<double>(), estimate["ci95"][0].get<double>()) << key;
    EXPECT_LT(estimate["value"].get<double>(), estimate["ci95"][1].get<double>()) << key;
  }
  EXPECT_EQ(json["correlations"].size(), 1u);
  EXPECT_GT(json["goodness"]["p"], 0.01);
  EXPECT_EQ(json["persons"][0]["goodness"]["confusion"].size(), 4u);
  const auto spec = load_observer(at("anna.toml").string());
  ASSERT_TRUE(spec) << spec.error().message;
  EXPECT_EQ(spec->name, "anna");
  EXPECT_EQ(spec->blur_sigma_samples, json["estimates"]["blur_sigma_samples"]["value"].get<double>());
  const std::string text = content_of(at("anna.toml"));
  EXPECT_THAT(text, HasSubstr(*sha256_of_file(at("a") / "shown_human.csv")));
  EXPECT_THAT(text, HasSubstr(*manifest_digest(at("a"))));
  EXPECT_THAT(content_of(at("anna.html")), HasSubstr("Residuals by size and contrast"));
  expect_refused(run(with(quick, {"--out", "anna.toml"})), 2, "exists already");
  EXPECT_EQ(content_of(at("anna.toml")), text);
}

TEST_F(ObserverFitCommand, FitsEveryPersonOfASessionAndSittingsWithOneCodeAsOnePerson) {
  const TemplateObserverSpec person{.name = "person", .blur_sigma_samples = 0.5, .internal_noise = 0.1};
  answer("one", person, 3);
  answer("a", person, 3);
  // Two more sittings of other answers to the same pictures: of bert, and of the first person again.
  const auto first = read_people(at("a"));
  ASSERT_TRUE(first) << first.error().message;
  for (const auto& [code, factor] : {std::pair("bert", 1.5), std::pair("bert", 2.5)}) {
    PersonRecord other = first->front();
    other.person.code = code;
    for (ShownPatch& shown : other.record.shown) shown.response_s += factor;
    ASSERT_TRUE(add_person(at("a"), other));
  }

  const Ended alone = run({"observer", "fit", "one", "--free", "internal_noise", "--replicates", "99", "--draws", "48",
                           "--json", "--out", "alone.toml"});
  const Ended all = run({"observer", "fit", "a", "--free", "internal_noise", "--replicates", "99", "--draws", "48",
                         "--json", "--out", "all.toml"});
  const Ended bert = run({"observer", "fit", "a", "--person", "bert", "--free", "internal_noise", "--replicates", "99",
                          "--draws", "48", "--json", "--out", "bert.toml"});

  const Json json = one_object(all);
  ASSERT_EQ(json["persons"].size(), 2u) << all.err;
  EXPECT_TRUE(json["persons"][0]["person"].is_null());
  EXPECT_EQ(json["persons"][1]["person"], "bert");
  const int answers = json["persons"][0]["answers"].get<int>();
  EXPECT_EQ(json["persons"][1]["answers"], 2 * answers);
  // The first person is fitted as if nobody else had answered, and bert as if he were alone.
  EXPECT_EQ(json["persons"][0]["estimates"], one_object(alone)["persons"][0]["estimates"]);
  EXPECT_EQ(json["persons"][1]["estimates"], one_object(bert)["persons"][0]["estimates"]);
  EXPECT_EQ(one_object(bert)["persons"].size(), 1u);
  expect_refused(run({"observer", "fit", "a", "--person", "cleo", "--free", "lapse", "--out", "x.toml"}), 2,
                 "no answers of person 'cleo'");
}

TEST_F(ObserverFitCommand, RefusesWhatCannotBeFittedInOneSentence) {
  answer("a", {}, 3);
  const std::vector<std::string> fit{"observer", "fit", "a", "--out", "x.toml", "--free"};

  expect_refused(run(with(fit, {"blurr_sigma_samples"})), 2, "did you mean 'blur_sigma_samples'");
  expect_refused(run(with(fit, {"lapse,lapse"})), 2, "listed twice");
  expect_refused(run(with(fit, {"lapse", "--from", "nobody"})), 2, "unknown observer");
  expect_refused(run({"observer", "fit", "a", "a", "--out", "x.toml", "--free", "lapse"}), 2, "the same answers");
  expect_refused(run({"observer", "fit", "none", "--out", "x.toml", "--free", "lapse"}), 2, "none");
  expect_refused(run({"observer", "fit", "a", "--out", "hvs-1.toml", "--free", "lapse"}), 2, "built in");
  expect_refused(run({"observer", "fit", "a", "--out", "x.txt", "--free", "lapse"}), 2, ".toml");
  expect_refused(run({"observer", "fit", "a", "--free", "lapse"}), 2, "--out");
  expect_refused(run({"observer"}), 2, "observer");
  // A changed answer.
  std::string text = content_of(at("a") / "shown_human.csv");
  folder_.write("a/shown_human.csv", text.substr(0, text.size() - 2) + "9\n");
  expect_refused(run(with(fit, {"lapse"})), 2, "shown_human.csv");
  EXPECT_FALSE(std::filesystem::exists(at("x.toml")));
}

TEST_F(ObserverFitCommand, WritesNoObserverForAnswersOfAnotherKind) {
  // Somebody who names the opposite direction now and then is no template observer with noise.
  answer("a", {}, 3, [](Trial& trial, std::size_t number) {
    if (number % 4 == 0) trial.answer = static_cast<Apex>((static_cast<int>(trial.truth) + 2) % 4);
  });

  const Ended ended = run(with(quick, {"--out", "x.toml"}));

  EXPECT_EQ(ended.code, 3) << ended.err;
  EXPECT_THAT(ended.err, HasSubstr("no parameter file was written"));
  const Json json = one_object(ended);
  EXPECT_FALSE(json["accepted"]);
  EXPECT_TRUE(json["parameter_file"].is_null());
  EXPECT_FALSE(std::filesystem::exists(at("x.toml")));
  EXPECT_THAT(content_of(at("x.html")), HasSubstr("MODEL REJECTED"));
}

TEST_F(ObserverFitCommand, RefusesAnObserverThatItCannotReadOrFit) {
  folder_.write("bad.toml", "name = \"bad\"\n");
  const auto from = [&](const std::string& observer) {
    return run({"observer", "fit", "a", "--from", observer, "--free", "internal_noise", "--out", "o.toml"});
  };

  expect_refused(from("./bad.toml"), 2, "blur_sigma_samples");
  expect_refused(from("hvs-2"), 2, "contrast_noise");  // a parameter of an observer with an eye
}

}  // namespace
}  // namespace todbench::testing
