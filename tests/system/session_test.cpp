// SPDX-License-Identifier: GPL-3.0-or-later
// Sessions of simulated cameras: what is in them, that they repeat, what they pass and fail.
#include <cmath>

#include "bench/session/manifest.h"
#include "bench/session/session_folder.h"
#include "sim_devices/sensor/effect_list.h"
#include "tests/support/source_file.h"
#include "tests/system/system_test_support.h"

namespace todbench::testing {
namespace {

using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsSupersetOf;
using ::testing::Not;
using ::testing::UnorderedElementsAre;

const std::set<std::string> curve_keys{"observer", "sensor",  "points",    "plan", "wall_s",
                                       "frames",   "verdict", "judgement", "bill"};
const std::set<std::string> point_keys{"delta_t_k",
                                       "set_delta_t_k",
                                       "seen_delta_t_k",
                                       "s75_mrad",
                                       "s75_ci95_mrad",
                                       "s75_direct_mrad",
                                       "s75_direct_se_mrad",
                                       "acuity_per_mrad",
                                       "trials",
                                       "verdict",
                                       "adequacy",
                                       "estimator",
                                       "interval",
                                       "dispersion",
                                       "clusters",
                                       "estimator_reason",
                                       "answers",
                                       "frames_per_presentation",
                                       "answers_reason"};
const std::set<std::string> effect_keys{"name", "decision", "reason", "predicted_change_percent"};

/// A folder with a plan, and the program run in it.
class Sessions : public ::testing::Test {
 protected:
  Ended run(const std::vector<std::string>& arguments, ChildOptions options = {}) {
    options.folder = folder_.path();
    return todbench(arguments, options);
  }
  std::filesystem::path at(const std::string& name) const { return folder_.path() / name; }
  void write(const std::string& name, const std::string& text) { folder_.write(name, text); }

 private:
  TemporaryFolder folder_;
};

TEST_F(Sessions, SimulateWritesEveryFileAndOneJsonObject) {
  write("plan.toml", small_plan(8));

  const Ended ended = run({"simulate", "./plan.toml", "--out", "s", "--json"});

  ASSERT_EQ(ended.code, 0) << ended.err;
  const Json json = one_object(ended);
  EXPECT_EQ(keys_of(json), curve_keys);
  EXPECT_EQ(json["bill"]["total_s"], json["wall_s"]);
  ASSERT_EQ(json["points"].size(), 1u);
  const Json& point = json["points"][0];
  EXPECT_EQ(keys_of(point), point_keys);
  EXPECT_EQ(point["delta_t_k"], 16.9);
  EXPECT_EQ(point["trials"], 8 * 20);  // twenty triangles on the plate
  EXPECT_DOUBLE_EQ(point["acuity_per_mrad"].get<double>() * point["s75_mrad"].get<double>(), 1);
  ASSERT_EQ(json["plan"].size(), all_effects.size());
  for (const auto& effect : json["plan"]) EXPECT_EQ(keys_of(effect), effect_keys);
  EXPECT_THAT(keys_of(json["frames"]), UnorderedElementsAre("used", "rejected"));
  expect_whole_session(at("s"), "complete");
  EXPECT_EQ(rows_in(at("s") / "trials.csv"), 160u);
  EXPECT_EQ(json["verdict"], "pass");
  EXPECT_EQ(json["judgement"], Json::parse(content_of(at("s") / "verdict.json")));
}

TEST_F(Sessions, MeasureWithASimulatedCameraComparesWithItsTwin) {
  write("plan.toml", small_measurement(8));

  const Ended ended = run({"measure", "./plan.toml", "--out", "m", "--json"});

  ASSERT_EQ(ended.code, 0) << ended.err;
  const Json json = one_object(ended);
  EXPECT_EQ(keys_of(json), curve_keys);
  EXPECT_EQ(keys_of(json["points"][0]), point_keys);
  EXPECT_TRUE(json["points"][0]["s75_direct_mrad"].is_null());  // exists only for a simulated curve
  EXPECT_EQ(json["plan"].size(), all_effects.size());           // of the twin
  expect_whole_session(at("m"), "complete");
  EXPECT_TRUE(std::filesystem::exists(at("m") / "comparison.json"));
  EXPECT_EQ(json["judgement"], Json::parse(content_of(at("m") / "verdict.json")));
  EXPECT_EQ(rows_in(at("m") / "trials_simulated.csv"), 160u);
}

TEST_F(Sessions, AContrastThatWasMeasuredOnceHasTheErrorOfThatMeasurement) {
  write("plan.toml", small_measurement(8,
                                       "[fit]\nestimator = \"twin-shape\"\n"
                                       "[[uncertainty.component]]\nname = \"distance\"\nvalue = 1\nunit = \"mm\"\n"));

  const Ended ended = run({"measure", "./plan.toml", "--out", "m"});

  EXPECT_THAT(ended.out, HasSubstr("interval includes the scatter of the measured contrast"));
  EXPECT_THAT(ended.out, Not(HasSubstr("measured once")));
  const Json point = Json::parse(content_of(at("m") / "fits.json"))["main"]["points"][0];
  EXPECT_EQ(point["delta_t_measurements"], 1);
  EXPECT_GT(point["delta_t_se_k"], 0);
  EXPECT_LT(point["delta_t_se_k"], 0.3);  // of 16.9 K
  EXPECT_GE(point["delta_t_degrees_of_freedom"], 1);
  // side, set contrast, effective contrast, its error.
  EXPECT_THAT(content_of(at("m") / "curve.csv"), ContainsRegex("measured,16\\.9,[0-9.]+,[0-9.]+,"));
  const Json verdict = Json::parse(content_of(at("m") / "verdict.json"));
  EXPECT_THAT(verdict["uncertainty_not_stated"].dump(), Not(HasSubstr("measured once")));
  const std::string report = content_of(at("m") / "report.html");
  EXPECT_THAT(report, HasSubstr("standard error over the measurements of the contrast and their triangles"));
  EXPECT_THAT(report, Not(HasSubstr("(measured once)")));
}

TEST_F(Sessions, TheStoredPlanRepeatsTheRunAlsoOnOneProcessor) {
  write("plan.toml", small_plan(8, "phases = 5\nskip = [\"quantisation\"]\n"));
  ASSERT_EQ(run({"simulate", "./plan.toml", "--seed", "7", "--out", "a"}).code, 0);

  const Ended again = run({"simulate", "a/session.toml", "--out", "b"}, {.one_processor = true});
  const Ended other_seed = run({"simulate", "a/session.toml", "--seed", "8", "--out", "c"});

  ASSERT_EQ(again.code, 0) << again.err;
  ASSERT_EQ(other_seed.code, 0) << other_seed.err;
  EXPECT_TRUE(same_content(at("a") / "trials.csv", at("b") / "trials.csv"));
  EXPECT_TRUE(same_content(at("a") / "fits.json", at("b") / "fits.json"));
  EXPECT_FALSE(same_content(at("a") / "trials.csv", at("c") / "trials.csv"));
}

TEST_F(Sessions, AMovedSessionRepeatsWithoutTheFilesItWasMadeFrom) {
  write("plates/mine.toml", content_of(source_file("tod/plate/tcat-a.toml")));
  write("plan.toml",
        "[target]\ndistance_m = 2\nplates = [\"plates/mine.toml\"]\nmountings = [\"identity\"]\n"
        "delta_t_k = [16.9]\nphases = 2\n[simulation]\naccuracy = \"draft\"\n");
  ASSERT_TRUE(completed(run({"simulate", "./plan.toml", "--out", "a"})));
  std::filesystem::remove_all(at("plates"));
  std::filesystem::rename(at("a"), at("moved"));

  const Ended again = run({"simulate", "moved/session.toml", "--out", "b"});

  ASSERT_TRUE(completed(again));
  EXPECT_TRUE(same_content(at("moved") / "trials.csv", at("b") / "trials.csv"));
}

TEST_F(Sessions, TheReportIsRebuiltFromTheFolderByteForByte) {
  write("plan.toml", small_measurement(4));
  ASSERT_TRUE(completed(run({"measure", "./plan.toml", "--out", "m"})));
  const std::string before = content_of(at("m") / "report.html");
  std::filesystem::remove(at("m") / "report.html");

  const Ended ended = run({"report", "m/", "--json"});

  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_EQ(one_object(ended), (Json{{"report", "m/report.html"}}));
  EXPECT_TRUE(content_of(at("m") / "report.html") == before);
  EXPECT_THAT(before, HasSubstr("0.01 K/count, 250 K at 0 counts"));
  EXPECT_THAT(before, Not(HasSubstr("uncalibrated")));
  expect_whole_session(at("m"), "complete");
}

TEST_F(Sessions, TheLetterheadOfAPlanStaysWithItsSession) {
  write("plans/plan.toml", small_measurement(2, "[report]\nletterhead = \"lab.toml\"\n"));
  const Ended missing = run({"measure", "plans/plan.toml", "--out", "m"});
  write("plans/lab.toml", "logo = \"none.png\"\nlogo_text = \"L\"\n");
  const Ended broken = run({"measure", "plans/plan.toml", "--out", "m"});
  write("other.toml", "title = \"Of the option\"\n");
  const Ended chosen = run({"measure", "plans/plan.toml", "--letterhead", "other.toml", "--out", "n"});
  write("plans/lab.toml", "title = \"Of the plan\"\n");

  ASSERT_TRUE(completed(run({"measure", "plans/plan.toml", "--out", "m"})));
  std::filesystem::remove(at("plans/lab.toml"));

  expect_refused(missing, 2, "lab.toml");
  expect_refused(broken, 2, "none.png");
  EXPECT_EQ(chosen.code, 2) << "a broken plan stays one";
  EXPECT_FALSE(std::filesystem::exists(at("n")));
  expect_whole_session(at("m"), "complete");
  EXPECT_THAT(content_of(at("m") / "session.toml"), HasSubstr("letterhead = \"inputs/letterhead.toml\""));
  EXPECT_THAT(content_of(at("m") / "report.html"), HasSubstr("Of the plan"));
  const std::string before = content_of(at("m") / "report.html");
  ASSERT_EQ(run({"report", "m"}).code, 0);
  EXPECT_TRUE(content_of(at("m") / "report.html") == before);
  ASSERT_TRUE(completed(run({"measure", "m/session.toml", "--letterhead", "other.toml", "--out", "n"})));
  EXPECT_THAT(content_of(at("n") / "report.html"), AllOf(HasSubstr("Of the option"), Not(HasSubstr("Of the plan"))));
  ASSERT_EQ(run({"report", "m", "--letterhead", "other.toml"}).code, 0);
  ASSERT_EQ(run({"report", "m"}).code, 0);
  EXPECT_THAT(content_of(at("m") / "report.html"), AllOf(HasSubstr("Of the option"), Not(HasSubstr("Of the plan"))));
  expect_whole_session(at("m"), "complete");
}

TEST_F(Sessions, TheReportShowsTheStoredVerdictAndNotOneByOtherLimits) {
  write("plan.toml", small_plan(8));
  ASSERT_EQ(run({"simulate", "./plan.toml", "--out", "s"}).code, 0);
  const std::string stored = content_of(at("s") / "verdict.json");
  write("s/session.toml",
        content_of(at("s") / "session.toml") + "\n[[limits.acuity]]\ndelta_t_k = 16.9\nleast_acuity_per_mrad = 123\n");
  ASSERT_TRUE(write_manifest(at("s")));

  const Ended ended = run({"report", "s"});

  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_THAT(content_of(at("s") / "report.html"),
              AllOf(HasSubstr("NO VERDICT"), Not(HasSubstr("at least 123 1/mrad"))));
  EXPECT_EQ(content_of(at("s") / "verdict.json"), stored);
}

TEST_F(Sessions, AnOldSessionIsJudgedOnceAndSaysSo) {
  write("plan.toml", small_plan(8, "[[limits.acuity]]\ndelta_t_k = 16.9\nleast_acuity_per_mrad = 0.01\n"));
  ASSERT_EQ(run({"simulate", "./plan.toml", "--out", "s"}).code, 0);
  std::filesystem::remove(at("s") / "verdict.json");
  ASSERT_TRUE(write_manifest(at("s")));

  const Ended first = run({"report", "s", "--json"});
  const std::string kept = content_of(at("s") / "verdict.json");
  const Ended second = run({"report", "s"});

  const std::string sentence = "The run of this session stored no verdict. The session was judged afterwards";
  EXPECT_EQ(one_object(first)["judged"], "afterwards");
  EXPECT_THAT(first.err, HasSubstr(sentence));
  EXPECT_THAT(second.err, HasSubstr(sentence));
  EXPECT_THAT(content_of(at("s") / "report.html"), AllOf(HasSubstr(sentence), HasSubstr("✓ PASS")));
  EXPECT_EQ(Json::parse(kept)["judged"], "afterwards");
  EXPECT_EQ(content_of(at("s") / "verdict.json"), kept);
  expect_whole_session(at("s"), "complete");
}

TEST_F(Sessions, AFolderInUseIsRefusedAndOverwrittenOnlyByForce) {
  write("plan.toml", small_plan(2));
  ASSERT_TRUE(completed(run({"simulate", "./plan.toml", "--out", "s"})));
  write("s/mine.txt", "a file of somebody else");
  const std::string first = content_of(at("s") / "trials.csv");

  const Ended refused = run({"simulate", "./plan.toml", "--out", "s", "--seed", "2"});
  const std::string kept = content_of(at("s") / "trials.csv");
  const Ended forced = run({"simulate", "--out", "s", "--seed", "2", "--force", "./plan.toml"});

  expect_refused(refused, 2, "s: the folder is not empty. Choose another one or overwrite it with --force");
  EXPECT_TRUE(kept == first);
  EXPECT_TRUE(completed(forced));
  EXPECT_TRUE(content_of(at("s") / "trials.csv") != first);
  EXPECT_EQ(content_of(at("s") / "mine.txt"), "a file of somebody else");
}

TEST_F(Sessions, ForceWithAnEffectForcesItAndDoesNotOverwrite) {
  write("plan.toml", small_plan(2));
  ASSERT_TRUE(completed(run({"simulate", "./plan.toml", "--out", "s"})));

  const Ended in_use = run({"simulate", "./plan.toml", "--force", "aberration", "--out", "s"});
  const Ended elsewhere = run({"simulate", "./plan.toml", "--force", "aberration", "--out", "t", "--json"});

  expect_refused(in_use, 2, "s: the folder is not empty");
  ASSERT_TRUE(completed(elsewhere));
  const Json json = one_object(elsewhere);
  for (const auto& effect : json["plan"]) {
    EXPECT_TRUE(effect["name"] != "aberration" || effect["decision"] == "simulate");
  }
  // A neutral effect that is forced changes nothing, bit for bit.
  EXPECT_TRUE(same_content(at("s") / "trials.csv", at("t") / "trials.csv"));
}

TEST_F(Sessions, SkippingAnEffectIsSaidAndChangesTheAnswers) {
  write("plan.toml", small_plan(4));
  ASSERT_TRUE(completed(run({"simulate", "./plan.toml", "--out", "s"})));

  const Ended ended = run({"simulate", "./plan.toml", "--skip", "quantisation,diffraction", "--out", "t", "--json"});

  ASSERT_TRUE(completed(ended));
  const Json json = one_object(ended);
  std::set<std::string> skipped;
  for (const auto& effect : json["plan"]) {
    if (effect["decision"] == "skip") skipped.insert(effect["name"]);
  }
  // With those that are neutral in this sensor.
  EXPECT_THAT(skipped, IsSupersetOf({"aberration", "fixed_pattern", "quantisation", "diffraction"}));
  EXPECT_EQ(skipped.count("detector"), 0u);
  EXPECT_FALSE(same_content(at("s") / "trials.csv", at("t") / "trials.csv"));
}

TEST_F(Sessions, WithoutOutEveryRunGetsAFolderOfItsOwn) {
  write("plan.toml", small_plan(1));

  // Within one second, so that the times in the names collide.
  std::vector<std::unique_ptr<ChildProcess>> children;
  for (int i = 0; i < 3; ++i) {
    children.push_back(
        std::make_unique<ChildProcess>(todbench_command({"simulate", "./plan.toml"}), ChildOptions{.folder = at("")}));
  }
  std::set<std::string> sessions;
  for (auto& child : children) {
    const Ended ended = child->wait();
    EXPECT_TRUE(completed(ended));
    sessions.insert(lines_of(ended.err).back());
  }

  EXPECT_EQ(sessions.size(), 3u);
}

TEST_F(Sessions, ALimitIsMetMissedOrNotDecidedByItsInterval) {
  write("plan.toml", small_plan(8));
  const Json point = one_object(run({"simulate", "./plan.toml", "--out", "s", "--json"}))["points"][0];
  const double low = 1 / point["s75_ci95_mrad"][1].get<double>();
  const double high = 1 / point["s75_ci95_mrad"][0].get<double>();
  const auto with_limit = [&](const std::string& name, double limit) {
    write(
        name + ".toml",
        small_plan(8, "[[limits.acuity]]\ndelta_t_k = 16.9\nleast_acuity_per_mrad = " + std::to_string(limit) + "\n"));
    return run({"simulate", "./" + name + ".toml", "--out", name});
  };

  const Ended met = with_limit("met", 0.99 * low);
  const Ended missed = with_limit("missed", 1.01 * high);
  const Ended open = with_limit("open", (low + high) / 2);

  EXPECT_EQ(met.code, 0) << met.err;
  EXPECT_THAT(met.out, HasSubstr("verdict: pass"));
  EXPECT_EQ(missed.code, 1) << missed.err;
  EXPECT_THAT(missed.out, HasSubstr("verdict: fail"));
  EXPECT_EQ(open.code, 3) << open.err;
  EXPECT_THAT(open.out, HasSubstr("the limit lies within"));
  EXPECT_THAT(content_of(at("missed") / "report.html"), HasSubstr("1/mrad"));
  const Json judgement = Json::parse(content_of(at("missed") / "verdict.json"));
  EXPECT_EQ(judgement["decision"], "fail");
  EXPECT_EQ(judgement["demands"][0]["kind"], "acuity");
  EXPECT_EQ(judgement["demands"][0]["unit"], "1/mrad");
  EXPECT_GT(judgement["demands"][0]["limit"], judgement["demands"][0]["interval"][1]);
}

TEST_F(Sessions, AThresholdThatTheDataDoNotShowIsInconclusive) {
  // 5 mK under a noise of 70 mK: no triangle of the plate is told from another.
  write("plan.toml", small_plan(4));

  const Ended ended = run({"simulate", "./plan.toml", "--delta-t-k", "16.9,0.005", "--out", "s", "--json"});

  EXPECT_EQ(ended.code, 3) << ended.err;
  const Json points = one_object(ended)["points"];
  ASSERT_EQ(points.size(), 2u);
  EXPECT_TRUE(points[0]["s75_direct_mrad"].is_number());  // the other contrast keeps what it has
  EXPECT_TRUE(points[1]["s75_direct_mrad"].is_null());
  const Json judgement = one_object(ended)["judgement"];
  EXPECT_EQ(judgement["decision"], "inconclusive");
  EXPECT_EQ(judgement["demands"][1]["kind"], "identified");
  EXPECT_EQ(judgement["demands"][1]["decision"], "inconclusive");
  EXPECT_TRUE(points[1]["s75_ci95_mrad"][0].is_null() || points[1]["s75_ci95_mrad"][1].is_null());
}

TEST_F(Sessions, WatchingASessionThatHasEndedShowsItsCurveAndItsVerdict) {
  write("plan.toml", small_plan(8));
  const Ended simulated = run({"simulate", "./plan.toml", "--out", "s", "--json"});
  const std::string trials = content_of(at("s") / "trials.csv");

  const Ended watched = run({"measure", "--watch", "s"});

  EXPECT_EQ(watched.code, simulated.code);
  // To three places, as the line shows it.
  const double acuity = one_object(simulated)["points"][0]["acuity_per_mrad"];
  EXPECT_THAT(watched.err, HasSubstr("16.9 K " + std::to_string(std::round(acuity * 1000) / 1000).substr(0, 5)));
  EXPECT_THAT(watched.out, HasSubstr("verdict: pass"));
  EXPECT_EQ(content_of(at("s") / "trials.csv"), trials);
  EXPECT_EQ(run({"verify", "s"}).code, 0) << "nothing was changed";
  expect_refused(run({"measure", "--watch", "none"}), 2, "none");
  expect_refused(run({"measure", "plan.toml", "--watch", "s"}), 2, "--watch");
  expect_refused(run({"measure"}), 2, "PLAN.toml is required");
}

TEST_F(Sessions, ThePageOfARunIsRefusedWhereOthersReachIt) {
  for (const char* address : {"0.0.0.0:0", "127.0.0.1"}) {
    write("plan.toml", small_plan(1));
    expect_refused(run({"demo", "--serve", address, "--out", "s"}), 2, "--serve");
    EXPECT_FALSE(std::filesystem::exists(at("s"))) << address;
  }
}

TEST_F(Sessions, CompareTellsEquivalentDifferentAndUndecidedApart) {
  const std::string sensor = content_of(source_file("sim_devices/sensors/sc2000.toml"));
  std::string blurred = sensor;
  blurred.replace(blurred.find("aberration_sigma_pitch = 0"), 26, "aberration_sigma_pitch = 1");
  write("blurred.toml", blurred);
  write("plan.toml", small_plan(16));
  ASSERT_EQ(run({"simulate", "./plan.toml", "--out", "a"}).code, 0);
  ASSERT_EQ(run({"simulate", "./plan.toml", "--out", "b", "--seed", "2"}).code, 0);
  ASSERT_EQ(run({"simulate", "./plan.toml", "--out", "c", "--sensor", "./blurred.toml"}).code, 0);

  const Ended same = run({"compare", "a", "b", "--margin-percent", "60", "--json", "--svg", "both.svg"});
  const Ended other = run({"compare", "a", "c", "--json"});
  const Ended open = run({"compare", "a", "b", "--margin-percent", "0.1", "--json"});

  EXPECT_EQ(same.code, 0) << same.out;
  EXPECT_THAT(content_of(at("both.svg")), AllOf(HasSubstr("<svg"), HasSubstr("</svg>")));
  EXPECT_EQ(other.code, 1) << other.out;
  EXPECT_EQ(open.code, 3) << open.out;
  const Json json = one_object(other);
  EXPECT_THAT(keys_of(json), UnorderedElementsAre("points", "verdict", "adequacy"));
  EXPECT_THAT(keys_of(json["points"][0]),
              UnorderedElementsAre("delta_t_k", "set_delta_t_k", "seen_delta_t_k", "ratio", "ratio_ci95",
                                   "p_difference", "p_equivalence", "margin_percent", "verdict"));
  EXPECT_GT(json["points"][0]["ratio"].get<double>(), 1);  // the sharper one sees more
  EXPECT_EQ(json["verdict"], "different");
}

TEST_F(Sessions, CompareRefusesWhatCannotBeComparedInEitherOrder) {
  std::string observer = content_of(source_file("hvs/observers/hvs-1.toml"));
  observer.replace(observer.find("internal_noise = 0.07"), 21, "internal_noise = 0.09");
  write("observer.toml", observer);
  write("plan.toml", small_plan(4, "[fit]\nestimator = \"weibull\"\nform = \"size\"\n"));
  write("form.toml", small_plan(4, "[fit]\nestimator = \"weibull\"\nform = \"acuity\"\n"));
  write("lapse.toml", small_plan(4, "[fit]\nestimator = \"weibull\"\nlapse = \"free\"\n"));
  write("observer_plan.toml", small_plan(4, "[observer]\nname = \"./observer.toml\"\n"));
  const auto simulate = [&](const std::string& plan, const std::string& out, const std::string& seed) {
    ASSERT_TRUE(completed(run({"simulate", "./" + plan, "--out", out, "--seed", seed})));
  };
  simulate("plan.toml", "a", "1");
  simulate("plan.toml", "again", "1");
  simulate("form.toml", "form", "2");
  simulate("lapse.toml", "lapse", "3");
  simulate("observer_plan.toml", "observer", "4");

  for (const auto& [other, sentence] :
       std::vector<std::pair<std::string, std::string>>{{"a", "the same trials"},
                                                        {"again", "the same trials"},
                                                        {"form", "fitted differently"},
                                                        {"lapse", "fitted differently"},
                                                        {"observer", "their parameters differ"}}) {
    expect_refused(run({"compare", "a", other}), 2, sentence);
    expect_refused(run({"compare", other, "a"}), 2, sentence);
  }
}

TEST_F(Sessions, CompareWithOtherPlatesDecidesNothing) {
  std::string plate = content_of(source_file("tod/plate/tcat-a.toml"));
  const auto at = plate.find("size_mm = ");
  ASSERT_NE(at, std::string::npos);
  const auto end = plate.find_first_of(" ,}\n", at + 10);
  plate.replace(at + 10, end - at - 10, std::to_string(std::stod(plate.substr(at + 10, end - at - 10)) * 0.99));
  write("plate.toml", plate);
  write("plan.toml", small_plan(16));
  std::string other = small_plan(16);
  other.replace(other.find("\"tcat-a\""), 8, "\"./plate.toml\"");
  write("other.toml", other);
  ASSERT_TRUE(completed(run({"simulate", "./plan.toml", "--out", "a"})));
  ASSERT_TRUE(completed(run({"simulate", "./other.toml", "--out", "b", "--seed", "2"})));

  for (const auto& [first, second] : {std::pair("a", "b"), std::pair("b", "a")}) {
    const Ended compared = run({"compare", first, second, "--margin-percent", "60", "--json"});

    EXPECT_EQ(compared.code, 3) << compared.out << compared.err;
    const Json json = one_object(compared);
    EXPECT_EQ(json["verdict"], "inconclusive");
    EXPECT_EQ(json["adequacy"]["findings"][0]["kind"], "identity");
    EXPECT_TRUE(json["points"][0]["ratio"].is_number());
  }
}

TEST_F(Sessions, TheMarginOfAComparisonIsTheSmallerOneOfBothPlans) {
  write("wide.toml", small_plan(4, "[limits]\nequivalence_margin_percent = 60\n"));
  write("narrow.toml", small_plan(4, "[limits]\nequivalence_margin_percent = 5\n"));
  ASSERT_NE(run({"simulate", "./wide.toml", "--out", "a"}).code, 2);
  ASSERT_NE(run({"simulate", "./narrow.toml", "--out", "b", "--seed", "2"}).code, 2);

  const Json forth = one_object(run({"compare", "a", "b", "--json"}));
  const Json back = one_object(run({"compare", "b", "a", "--json"}));

  EXPECT_EQ(forth["points"][0]["margin_percent"], 5);
  EXPECT_EQ(back["points"][0]["margin_percent"], 5);
  EXPECT_EQ(forth["verdict"], back["verdict"]);
}

TEST_F(Sessions, QuietMeansNothingOnStandardErrorAndNoTerminalNoControlCharacters) {
  write("plan.toml", small_plan(2));

  const Ended plain = run({"simulate", "./plan.toml", "--out", "s"});
  const Ended quiet = run({"simulate", "./plan.toml", "--out", "t", "--quiet"}, {.setenv = {{"NO_COLOR", "1"}}});

  auto said = lines_of(plain.err);
  // On a busy machine a run takes long enough for a line of the curve so far.
  std::erase_if(said, [](const std::string& line) { return line.starts_with("acuity [1/mrad] so far"); });
  EXPECT_THAT(said, ElementsAre("simulating sc2000", "estimating sc2000 directly", "session: s"));
  EXPECT_EQ(quiet.err, "");
  for (const char c : plain.err + plain.out) EXPECT_TRUE(c == '\n' || c < 0 || c >= 0x20) << static_cast<int>(c);
}

TEST_F(Sessions, OverdueCalibrationStopsAMeasurementBeforeItBeginsAndNotASimulation) {
  write("plan.toml", small_measurement(2,
                                       "[[instrument]]\nname = \"black body\"\nserial = \"B7\"\n"
                                       "calibration_due = \"2020-01-31\"\n"));

  const Ended measured = run({"measure", "./plan.toml", "--out", "m"});
  const Ended simulated = run({"simulate", "./plan.toml", "--out", "s"});

  expect_refused(measured, 6, "calibration overdue: black body B7 (due 2020-01-31)");
  EXPECT_FALSE(std::filesystem::exists(at("m")));
  EXPECT_TRUE(completed(simulated));
}

TEST_F(Sessions, ACameraWithoutATemperatureScaleIsACalibrationError) {
  write("plan.toml", "[camera]\nid = \"file:" + source_file("tests/golden/real/lepton_a_160x120_u16le.raw") +
                         "?width=160&height=120\"\nifov_mrad = 6.2\n"
                         "[target]\nkind = \"prompt\"\ndistance_m = 1\nplates = [\"tcat-a\"]\ndelta_t_k = [16.9]\n"
                         "phases = 1\n");

  const Ended ended = run({"measure", "./plan.toml", "--out", "m"});

  expect_refused(ended, 6, "has no temperature scale: contrasts in kelvin cannot be measured");
}

TEST_F(Sessions, ADamagedSessionIsNamedByFile) {
  write("plan.toml", small_plan(2));
  ASSERT_TRUE(completed(run({"simulate", "./plan.toml", "--out", "s"})));
  write("s/fits.json", "{\"main\": ");

  expect_refused(run({"report", "s"}), 2, "s: the session was changed: fits.json was changed after the session ended");
  expect_refused(run({"compare", "s", "s", "--accept-changed"}), 2, "s/fits.json: not valid JSON");
}

}  // namespace
}  // namespace todbench::testing
