// SPDX-License-Identifier: GPL-3.0-or-later
// Recorded frames that are judged again: by the same observer, by another one, through a package.
#include "bench/enhance/judge_again.h"
#include "tests/support/verify_manifest.h"

#include <gmock/gmock.h>

#include <fstream>
#include <regex>

#include "bench/session/fit_record.h"
#include "tests/bench/run/measured_session.h"

namespace todbench {
namespace {

using ::testing::Contains;
using testing::content_of;
using ::testing::HasSubstr;
using testing::MeasuredSession;

class JudgedAgain : public MeasuredSession {
 protected:
  [[nodiscard]] EnhancementPackage package(const std::string& stages) const {
    const std::filesystem::path file = at("package.toml");
    std::ofstream(file) << "name = \"p\"\n" << stages;
    return read_package(file).value();
  }
};

TEST_F(JudgedAgain, ByTheSameObserverHaveTheSameNumbersAndNameTheirOrigin) {
  plan_.limits.acuity.push_back({.delta_t_k = 16.9, .least_acuity_per_mrad = 0.1});
  ASSERT_TRUE(measure("m"));

  const auto run = judge_again(at("m"), {.observer = "hvs-1"}, options("j"), {}, {});

  ASSERT_TRUE(run) << run.error().message;
  for (const char* file :
       {"trials.csv", "targets.csv", "curve.csv", "fits.json", "trials_simulated.csv", "verdict.json"})
    EXPECT_EQ(content_of(at("j") / file), content_of(at("m") / file)) << file;
  EXPECT_THAT(verify_manifest(at("j")).value(), ::testing::IsEmpty());
  const auto session = open_session(at("j"), {});
  ASSERT_TRUE(session) << session.error().message;
  ASSERT_TRUE(session->provenance.origin);
  const OriginRecord& origin = *session->provenance.origin;
  EXPECT_EQ(origin.session, at("m").string());
  EXPECT_EQ(origin.manifest_sha256, manifest_digest(at("m")).value());
  EXPECT_EQ(origin.then, origin.now);
  EXPECT_EQ(origin.now.observer, "hvs-1");
  EXPECT_EQ(origin.now.observer_sha256.size(), 64u);
  EXPECT_THAT(content_of(at("j") / "report.html"), HasSubstr("judged again"));
}

TEST_F(JudgedAgain, ByANoisierObserverHaveTheSameTargetsAndALowerAcuity) {
  ASSERT_TRUE(measure("m"));
  std::string text = find_resource(ResourceKind::observer, "hvs-1")->text;
  const std::filesystem::path file = at("noisy.toml");
  std::ofstream(file) << std::regex_replace(
      std::regex_replace(text, std::regex("name = \"hvs-1\""), "name = \"noisy\""),
      std::regex("\ninternal_noise = [0-9.]+"), "\ninternal_noise = 0.5");

  const auto run = judge_again(at("m"), {.observer = file.string()}, options("j"), {}, {});

  ASSERT_TRUE(run) << run.error().message;
  EXPECT_EQ(run->curve.observer, "noisy");
  const auto then = read_session(at("m")).value(), now = read_session(at("j")).value();
  ASSERT_EQ(now.trials.size(), then.trials.size());
  int right_then = 0, right_now = 0;
  for (std::size_t i = 0; i < now.trials.size(); ++i) {
    EXPECT_EQ(now.trials[i].frame, then.trials[i].frame);
    EXPECT_EQ(now.trials[i].truth, then.trials[i].truth);
    right_then += then.trials[i].correct() ? 1 : 0;
    right_now += now.trials[i].correct() ? 1 : 0;
  }
  EXPECT_LT(right_now, right_then - 10);
  EXPECT_EQ(now.provenance.origin->then.observer, "hvs-1");
  EXPECT_EQ(now.provenance.origin->now.observer, "noisy");
}

TEST_F(JudgedAgain, ThroughAPackageThatChangesNothingHaveTheSameAnswers) {
  plan_.schedule.answers = AnswersChoice::binary;
  plan_.schedule.frames_per_presentation = {0};
  ASSERT_TRUE(measure("m"));

  const auto same =
      judge_again(at("m"), {.package = package("[[stage]]\nkind = \"kernel\"\nvalues = [0, 0, 0, 0, 1, 0, 0, 0, 0]\n")},
                  options("same"), {}, {});
  const auto blurred = judge_again(at("m"),
                                   {.package = package("[[stage]]\nkind = \"kernel\"\nvalues = [0.1111, 0.1111, "
                                                       "0.1111, 0.1111, 0.1112, 0.1111, 0.1111, 0.1111, 0.1111]\n")},
                                   options("blurred"), {}, {});

  ASSERT_TRUE(same && blurred) << (same ? blurred.error() : same.error()).message;
  const auto then = read_session(at("m")).value(), now = read_session(at("same")).value(),
             worse = read_session(at("blurred")).value();
  ASSERT_EQ(now.trials.size(), then.trials.size());
  int differ = 0, changed = 0;
  for (std::size_t i = 0; i < now.trials.size(); ++i) {
    differ += now.trials[i].answer != then.trials[i].answer ? 1 : 0;
    changed += worse.trials[i].answer != then.trials[i].answer ? 1 : 0;
  }
  // The contrast of a package's output is estimated again, which may turn an answer at the noise.
  EXPECT_LE(differ, static_cast<int>(now.trials.size()) / 20);
  EXPECT_GT(changed, 3 * differ);
  EXPECT_EQ(now.provenance.origin->now.package, "p");
  EXPECT_EQ(now.provenance.origin->now.package_sha256.size(), 64u);
  EXPECT_THAT(now.provenance.run->notes, Contains(HasSubstr("frames pass through package p")));
}

TEST_F(JudgedAgain, WithoutFramesOrWithChangedFilesAreRefusedAndLeaveNoFolder) {
  plan_.measurement.record_frames = false;
  ASSERT_TRUE(measure("m"));

  const auto none = judge_again(at("m"), {.observer = "hvs-1"}, options("j"), {}, {});

  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, ErrorCode::invalid_input);
  EXPECT_THAT(none.error().message, HasSubstr("has no recorded frames"));
  std::ofstream(at("m") / "trials.csv", std::ios::app) << "\n";
  const auto changed = judge_again(at("m"), {.observer = "hvs-1"}, options("j"), {}, {});
  ASSERT_FALSE(changed);
  EXPECT_THAT(changed.error().message, HasSubstr("the session was changed"));
  EXPECT_FALSE(std::filesystem::exists(at("j")));
}

TEST_F(JudgedAgain, ByAnObserverWithAnEyeNeedADisplay) {
  ASSERT_TRUE(measure("m"));

  const auto blind = judge_again(at("m"), {.observer = "hvs-2"}, options("j"), {}, {});

  ASSERT_FALSE(blind);
  EXPECT_EQ(blind.error().code, ErrorCode::invalid_input);
  EXPECT_THAT(blind.error().message, HasSubstr("[display]"));
  EXPECT_FALSE(std::filesystem::exists(at("j")));
}

}  // namespace
}  // namespace todbench
