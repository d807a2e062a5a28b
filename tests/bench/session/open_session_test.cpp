// SPDX-License-Identifier: GPL-3.0-or-later
// Sessions whose files were changed after they had ended: told by every reader, whatever was changed.
#include "bench/session/open_session.h"

#include <gmock/gmock.h>

#include <random>

#include "bench/session/foreign_files.h"
#include "bench/session/human_record.h"
#include "bench/text/files.h"
#include "bench/text/json.h"
#include "tests/bench/session/trial_values.h"
#include "tests/support/source_file.h"
#include "tests/support/temporary_folder.h"

namespace todbench {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// A session as measure writes it, with what may come afterwards.
std::filesystem::path write_session(const testing::TemporaryFolder& parent) {
  auto folder = SessionFolder::create(parent.path() / "s", ExistingFolder::refuse).value();
  EXPECT_TRUE(folder.write_plan(LoadedPlan::load(Plan{}).value()));
  EXPECT_TRUE(folder.log("started"));
  for (const SessionCurve which : {SessionCurve::main, SessionCurve::twin}) {
    TrialsWriter writer = folder.open_trials(which).value();
    for (const Trial& trial : testing::random_trials(5)) EXPECT_TRUE(writer.append(trial));
    TargetsWriter targets = folder.open_targets(which).value();
    EXPECT_TRUE(targets.append(testing::full_presentation()));
  }
  EXPECT_TRUE(folder.write_curves(testing::full_curve(), testing::full_curve(), Side::measured));
  EXPECT_TRUE(folder.write_verdict(judge({.limits = {}, .curve = testing::full_curve(), .comparison = std::nullopt})));
  EXPECT_TRUE(folder.write_report("<!DOCTYPE html><title>75 %</title>"));
  std::filesystem::create_directories(folder.path() / "frames");
  EXPECT_TRUE(write_file_atomically(folder.path() / "frames" / "camera.todrec", "frames 0123456789"));
  EXPECT_TRUE(folder.finish(begin_provenance(Plan{}, Side::measured), SessionState::complete));
  std::vector<Trial> answers = testing::random_trials(2);
  const std::vector<ShownPatch> shown(2, ShownPatch{.kelvin = cv::Mat1f(2, 2, 300.5F), .limit_ms = {}});
  EXPECT_TRUE(
      add_person(folder.path(), {.person = {}, .record = human_record(std::move(answers), shown, Plan{}).value()}));
  return folder.path();
}

class ChangedSession : public ::testing::Test {
 protected:
  [[nodiscard]] std::filesystem::path at(const std::string& file) const { return session_ / file; }
  [[nodiscard]] std::string content(const std::string& file) const { return testing::content_of(at(file)); }
  void put(const std::string& file, const std::string& text) const {
    std::filesystem::create_directories(at(file).parent_path());
    parent_.write("s/" + file, text);
  }
  [[nodiscard]] std::string refusal() const {
    const auto session = open_session(session_, {});
    EXPECT_TRUE(session || session.error().code == ErrorCode::invalid_input);
    return session ? "" : session.error().message;
  }

  testing::TemporaryFolder parent_;
  std::filesystem::path session_ = write_session(parent_);
};

TEST_F(ChangedSession, IsReadAsLongAsNothingWasChanged) {
  const auto session = open_session(session_, {});

  ASSERT_TRUE(session) << session.error().message;
  EXPECT_THAT(session->accepted_changes, IsEmpty());
  EXPECT_FALSE(session->cut_off);
  EXPECT_EQ(session->manifest_sha256.size(), 64u);
  EXPECT_EQ(session->manifest_sha256, digest_of(manifest_entries(session_).value()));
}

TEST_F(ChangedSession, IsRefusedForEveryDigitOfEveryFile) {
  std::vector<std::string> files = session_files(session_);
  files.emplace_back(manifest_name);
  std::mt19937 random(7);
  std::size_t changes = 0;
  for (const std::string& file : files) {
    const std::string whole = content(file);
    std::vector<std::size_t> digits;
    for (std::size_t i = 0; i < whole.size(); ++i) {
      if (whole[i] >= '0' && whole[i] <= '9') digits.push_back(i);
    }
    std::shuffle(digits.begin(), digits.end(), random);
    digits.resize(std::min<std::size_t>(digits.size(), 25));
    for (const std::size_t place : digits) {
      std::string changed = whole;
      changed[place] = changed[place] == '9' ? '0' : static_cast<char>(changed[place] + 1);
      put(file, changed);
      EXPECT_THAT(refusal(), HasSubstr(file)) << file << " at " << place;
      ++changes;
    }
    put(file, whole);
  }

  EXPECT_GT(changes, 300u);
  EXPECT_EQ(refusal(), "");
}

TEST_F(ChangedSession, IsRefusedInOneSentenceThatNamesTheFile) {
  put("fits.json", content("fits.json") + " ");
  EXPECT_EQ(refusal(), session_.string() +
                           ": the session was changed: fits.json was changed after the session ended (use "
                           "--accept-changed to read it anyway)");

  std::filesystem::remove(at("trials.csv"));
  put("inputs/other.toml", "x");
  EXPECT_THAT(refusal(), HasSubstr("fits.json was changed, trials.csv was removed, inputs/other.toml was added after"));
}

TEST_F(ChangedSession, SeveralFilesAreListedAsInASentence) {
  const auto added = [&](int files) {
    for (int i = 0; i < files; ++i) put("inputs/" + std::to_string(i) + ".toml", "x");
    return refusal();
  };
  EXPECT_THAT(added(2), HasSubstr(": inputs/0.toml and inputs/1.toml were added"));
  EXPECT_THAT(added(3), HasSubstr(": inputs/0.toml, inputs/1.toml and inputs/2.toml were added"));
  EXPECT_THAT(added(7), HasSubstr("inputs/2.toml, inputs/3.toml and 3 more were added"));
}

TEST_F(ChangedSession, FilesThatNobodyReadsAreForeignAndDoNotStopAReader) {
  put("notes/mine.txt", "x");
  std::filesystem::remove(at("report.html"));

  const auto check = check_session(session_);

  ASSERT_TRUE(check);
  EXPECT_EQ(check->condition, SessionCondition::changed);
  EXPECT_THAT(check->files.foreign, ElementsAre("notes/mine.txt"));
  EXPECT_THAT(check->files.missing, ElementsAre("report.html"));
  EXPECT_EQ(refusal(), "");
}

TEST_F(ChangedSession, AnEntryThatFollowsAChangedFileChangesTheManifest) {
  const std::string before = content("fits.json");
  std::string after = before;
  after[after.find("75")] = '8';
  put("fits.json", after);
  std::string manifest = content("manifest.json");
  manifest.replace(manifest.find(sha256_of(before)), 64, sha256_of(after));
  put("manifest.json", manifest);

  const auto check = check_session(session_);

  ASSERT_TRUE(check);
  EXPECT_THAT(check->files.changed, ElementsAre("manifest.json"));
  EXPECT_THAT(refusal(), HasSubstr("manifest.json was changed"));
  EXPECT_FALSE(refresh_manifest(session_, {"report.html"}));
}

TEST_F(ChangedSession, AWholeNewManifestHasAnotherDigestThanThePageThatWasPrinted) {
  const std::string printed = open_session(session_, {})->manifest_sha256;
  put("curve.csv", content("curve.csv") + "\n");
  ASSERT_TRUE(write_manifest(session_));

  EXPECT_NE(open_session(session_, {})->manifest_sha256, printed);
}

TEST_F(ChangedSession, TheDigestDoesNotDependOnThePagesThatPrintIt) {
  const std::string before = open_session(session_, {})->manifest_sha256;
  put("report.html", "another page");
  ASSERT_TRUE(refresh_manifest(session_, {"report.html"}));

  EXPECT_EQ(open_session(session_, {})->manifest_sha256, before);
}

TEST_F(ChangedSession, IsReadWhereChangesAreAcceptedAndNamesThem) {
  put("curve.csv", content("curve.csv") + "\n");
  put("report.html", "another page");

  const auto session = open_session(session_, {.accept_changed = true});

  ASSERT_TRUE(session) << session.error().message;
  EXPECT_THAT(session->accepted_changes, ElementsAre("curve.csv", "report.html"));
}

TEST_F(ChangedSession, WithoutAManifestIsOnlyACutOffRunWhereItSaysSo) {
  std::filesystem::remove(at("manifest.json"));
  EXPECT_THAT(refusal(), HasSubstr("manifest.json was removed"));
  EXPECT_FALSE(open_session(session_, {.accept_cut_off = true}));

  std::string provenance = content("provenance.json");
  provenance.replace(provenance.find("\"complete\""), 10, "\"running\"");
  put("provenance.json", provenance);
  EXPECT_THAT(refusal(), HasSubstr("the run is not finished or was cut off"));
  const auto session = open_session(session_, {.accept_cut_off = true});
  ASSERT_TRUE(session) << session.error().message;
  EXPECT_TRUE(session->cut_off);
  EXPECT_EQ(session->manifest_sha256, "");
}

TEST_F(ChangedSession, TakesNoAnswersOfAPerson) {
  const std::string answers = content("trials_human.csv");
  put("trials.csv", content("trials.csv") + "\n");

  const auto written = add_person(
      session_,
      {.person = {}, .record = human_record(testing::random_trials(3), std::vector<ShownPatch>(3), Plan{}).value()});

  ASSERT_FALSE(written);
  EXPECT_THAT(written.error().message, HasSubstr("trials.csv was changed after the session ended"));
  EXPECT_EQ(content("trials_human.csv"), answers);
}

TEST_F(ChangedSession, NothingIsWrittenWhereALinkOrAForeignFileIs) {
  EXPECT_TRUE(require_no_foreign_file(session_));
  put("notes.txt", "mine");
  EXPECT_THAT(require_no_foreign_file(session_).error().message, HasSubstr("notes.txt"));
  EXPECT_FALSE(require_intact(session_));
  EXPECT_EQ(refusal(), "") << "it may still be read";
  std::filesystem::remove(at("notes.txt"));

  std::filesystem::create_symlink("/nowhere", at(".report.csv.part"));
  EXPECT_THAT(require_no_foreign_file(session_).error().message, HasSubstr("symbolic link"));
  EXPECT_THAT(require_no_links(session_).error().message, HasSubstr(".report.csv.part"));
}

TEST_F(ChangedSession, ALinkIsNamedAndNotTrusted) {
  const testing::TemporaryFolder elsewhere;
  for (const std::string name : {"trials.csv", "manifest.json", "report.html"}) {
    const auto outside = elsewhere.write(name, content(name));
    std::filesystem::rename(at(name), at(name + ".kept"));
    std::filesystem::create_symlink(outside, at(name));
    std::filesystem::copy_file(at(name + ".kept"), elsewhere.path() / "kept");
    std::filesystem::remove(at(name + ".kept"));

    const auto check = check_session(session_);
    ASSERT_TRUE(check) << check.error().message;
    EXPECT_THAT(check->files.links, ElementsAre(name));
    EXPECT_EQ(check->condition, SessionCondition::changed);
    EXPECT_THAT(check->sentence, HasSubstr(name + " is a symbolic link"));
    EXPECT_THAT(check->sentence, HasSubstr("put a copy in place"));
    EXPECT_THAT(refusal(), HasSubstr("is a symbolic link"));
    EXPECT_FALSE(require_intact(session_));

    std::filesystem::remove(at(name));
    std::filesystem::copy_file(elsewhere.path() / "kept", at(name));
    std::filesystem::remove(elsewhere.path() / "kept");
  }
  EXPECT_EQ(refusal(), "");

  std::filesystem::copy(at("frames"), elsewhere.path() / "frames");
  std::filesystem::remove_all(at("frames"));
  std::filesystem::create_directory_symlink(elsewhere.path() / "frames", at("frames"));
  EXPECT_THAT(check_session(session_)->files.links, ElementsAre("frames/camera.todrec"));
  EXPECT_THAT(refusal(), HasSubstr("frames/camera.todrec is a symbolic link or lies in a linked folder"));
}

TEST_F(ChangedSession, ALinkedFolderIsNotEmptiedByANewRun) {
  const testing::TemporaryFolder elsewhere;
  const auto file = elsewhere.write("precious.toml", "mine");
  std::filesystem::remove_all(at("inputs"));
  std::filesystem::create_directory_symlink(elsewhere.path(), at("inputs"));

  EXPECT_FALSE(SessionFolder::create(session_, ExistingFolder::overwrite));
  EXPECT_EQ(testing::content_of(file), "mine");
}

TEST_F(ChangedSession, PartsThatAKilledProgramLeftGoWithTheNextRun) {
  put(".trials.csv.0123456789abcdef.part", "half");

  ASSERT_TRUE(SessionFolder::create(session_, ExistingFolder::overwrite));
  EXPECT_FALSE(std::filesystem::exists(at(".trials.csv.0123456789abcdef.part")));
}

TEST_F(ChangedSession, AManifestOfAnEarlierVersionIsTakenWithoutItsOwnDigest) {
  Json manifest = Json::parse(content("manifest.json"));
  manifest.erase("manifest_sha256");
  manifest.erase("entries_sha256");
  put("manifest.json", to_page(manifest));

  EXPECT_EQ(refusal(), "");
}

TEST(ReadSession, OfAVersionWithoutAnEstimatorStaysFittedWithAWeibullFunction) {
  const auto session = read_session(source_file("tests/golden/session-0.1"));

  ASSERT_TRUE(session) << session.error().message;
  EXPECT_EQ(session->plan.fit.estimator, EstimatorChoice::weibull);
  EXPECT_EQ(session->plan.schedule.answers, AnswersChoice::binary);
  EXPECT_EQ(session->plan.schedule.frames_per_presentation, std::vector<int>{1});
  for (const TodPoint& point : session->curve->points) {
    EXPECT_FALSE(point.fit.twin_shape);
    EXPECT_FALSE(point.estimator_reason);
    EXPECT_FALSE(point.answers);
  }
}

}  // namespace
}  // namespace todbench
