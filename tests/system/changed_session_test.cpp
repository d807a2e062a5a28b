// SPDX-License-Identifier: GPL-3.0-or-later
// Sessions that somebody changed after they had ended: refused by every command that reads one, or read and said.
#include <algorithm>
#include <memory>
#include <random>

#include "acquisition/base/process.h"
#include "bench/session/manifest.h"
#include "tests/system/system_test_support.h"

namespace todbench::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

const std::vector<std::string> range_of_m{"range", "--tod", "m", "--size-m", "5", "--delta-t-k", "16.9", "--json"};

/// A measured session with recorded frames, its twin and its targets; and a copy of it to compare with.
class ChangedSessions : public ::testing::Test {
 protected:
  /// Measured once for all cases of a process.
  static void SetUpTestSuite() {
    measured_ = std::make_unique<TemporaryFolder>();
    measured_->write("plan.toml", small_measurement(8, "[measurement]\nrecord_frames = true\n"));
    ChildOptions options;
    options.folder = measured_->path();
    ASSERT_TRUE(completed(todbench({"measure", "./plan.toml", "--out", "m"}, options)));
  }
  static void TearDownTestSuite() { measured_.reset(); }
  ChangedSessions() {
    std::filesystem::copy(measured_->path(), folder_.path(), std::filesystem::copy_options::recursive);
    std::filesystem::copy(at("m"), at("other"), std::filesystem::copy_options::recursive);
  }
  Ended run(const std::vector<std::string>& arguments) const {
    ChildOptions options;
    options.folder = folder_.path();
    return todbench(arguments, options);
  }
  std::filesystem::path at(const std::string& name) const { return folder_.path() / name; }
  void write(const std::string& name, const std::string& text) const { folder_.write(name, text); }
  /// One digit of a file, the one at `share` of all its digits, counted up.
  void change_a_digit(const std::string& file, double share) const {
    std::string content = content_of(at(file));
    std::vector<std::size_t> digits;
    for (std::size_t i = 0; i < content.size(); ++i) {
      if (content[i] >= '0' && content[i] <= '9') digits.push_back(i);
    }
    ASSERT_FALSE(digits.empty()) << file;
    char& digit = content[digits[static_cast<std::size_t>(share * static_cast<double>(digits.size() - 1))]];
    digit = digit == '9' ? '0' : static_cast<char>(digit + 1);
    write(file, content);
  }

  static inline std::unique_ptr<TemporaryFolder> measured_;
  TemporaryFolder folder_;
};

TEST_F(ChangedSessions, AreRefusedByEveryCommandWhateverWasChanged) {
  const std::vector<std::vector<std::string>> readers{
      {"report", "m"}, {"compare", "m", "other"},     {"compare", "other", "m"},
      range_of_m,      {"replay", "m", "--out", "r"}, {"cost", "--session", "m", "--budget-s", "1"}};
  std::vector<std::string> files = session_files(at("m"));
  files.emplace_back(manifest_name);
  ASSERT_GT(files.size(), 14u);
  std::mt19937 random(11);
  std::uniform_real_distribution<double> share(0, 1);
  for (const std::string& file : files) {
    const std::string before = content_of(at("m") / file);
    for (const auto& reader : readers) {
      change_a_digit("m/" + file, share(random));
      // A changed entry of the manifest differs from its file, too, which is named beside it.
      expect_refused(run(reader), 2, file == manifest_name ? file : file + " was changed after the session ended");
      write("m/" + file, before);
    }
  }
  EXPECT_FALSE(std::filesystem::exists(at("r")));
  EXPECT_EQ(run({"verify", "m"}).code, 0);
}

TEST_F(ChangedSessions, AHistoryIsNotCheckedForWhatItDoesNotHold) {
  ASSERT_EQ(run({"history", "add", "m", "--index", "index.sqlite"}).code, 0);
  const auto check = [&](std::vector<std::string> words) {
    words.insert(words.begin(), {"history", "check", "--index", "index.sqlite"});
    return run(words);
  };

  EXPECT_EQ(check({"--measure", "acuity", "--at-least", "0.000001"}).code, 0);
  EXPECT_EQ(check({"--measure", "acuity", "--at-least", "1000000"}).code, 1);
  expect_refused(check({"--measure", "acuitx", "--at-least", "1000000"}), 4, "acuitx");
  expect_refused(check({"nobody"}), 4, "nobody");
  expect_refused(check({"--measure", "acuity", "--at-least", "-1"}), 2, "above 0");
}

TEST_F(ChangedSessions, AreNotAddedToAHistoryAndGetNoCertificate) {
  change_a_digit("m/trials.csv", 0.5);

  const Ended added = run({"history", "add", "m", "--index", "index.sqlite"});
  EXPECT_EQ(added.code, 2);
  EXPECT_THAT(added.out, HasSubstr("added 0"));
  EXPECT_THAT(added.err, HasSubstr("trials.csv was changed after the session"));
  const Ended certificate = run({"certificate", "m", "--dcc", "m.xml"});

  expect_refused(certificate, 2, "trials.csv was changed after the session");
  EXPECT_THAT(certificate.err, ::testing::Not(HasSubstr("--accept-changed"))) << "it has no such option";
}

TEST_F(ChangedSessions, VerifySaysWhyASessionWithAForeignFileIsNotIntact) {
  write("m/notes/mine.txt", "x");

  const Ended ended = run({"verify", "m", "--json"});

  EXPECT_EQ(ended.code, 2);
  EXPECT_EQ(one_object(ended)["condition"], "changed");
  ASSERT_TRUE(one_object(ended)["reason"].is_string());
  EXPECT_THAT(one_object(ended)["reason"].get<std::string>(), HasSubstr("foreign"));
}

TEST_F(ChangedSessions, VerifyTellsWhatWasChangedRemovedAndAdded) {
  const Json before = one_object(run({"verify", "m", "--json"}));
  change_a_digit("m/fits.json", 0.5);
  std::filesystem::remove(at("m/log.txt"));
  write("m/notes/mine.txt", "x");

  const Ended ended = run({"verify", "m", "--json"});

  EXPECT_EQ(before["intact"], true);
  EXPECT_TRUE(before["signed_by"].is_null());
  EXPECT_THAT(content_of(at("m/report.html")), HasSubstr(before["manifest_sha256"].get<std::string>()));
  EXPECT_EQ(ended.code, 2);
  const Json json = one_object(ended);
  EXPECT_EQ(json["intact"], false);
  EXPECT_EQ(json["changed"], Json({"fits.json"}));
  EXPECT_EQ(json["missing"], Json({"log.txt"}));
  EXPECT_EQ(json["foreign"], Json({"notes/mine.txt"}));
  EXPECT_EQ(json["manifest_sha256"], before["manifest_sha256"]);
}

TEST_F(ChangedSessions, AreReadWhereThatIsAskedForAndStayChanged) {
  change_a_digit("m/fits.json", 0.9);
  const std::string manifest = content_of(at("m/manifest.json"));

  const Ended report = run({"report", "m", "--accept-changed", "--json", "--quiet"});
  const Ended range = run({"range", "--tod", "m", "--size-m", "5", "--delta-t-k", "16.9", "--accept-changed"});
  ASSERT_TRUE(completed(run({"measure", "./plan.toml", "--seed", "2", "--out", "second"})));
  const Ended compare = run({"compare", "second", "m", "--accept-changed", "--json"});
  const Ended verify = run({"verify", "m", "--json"});

  EXPECT_EQ(report.code, 0) << report.err;
  EXPECT_EQ(one_object(report)["accepted_changes"], Json({"fits.json"}));
  EXPECT_THAT(report.err, HasSubstr("fits.json"));
  EXPECT_THAT(content_of(at("m/report.html")), AllOf(HasSubstr("FILES CHANGED"), HasSubstr("fits.json")));
  EXPECT_THAT(range.err, HasSubstr("fits.json"));
  EXPECT_THAT(range.out, HasSubstr("fits.json"));
  EXPECT_THAT(one_object(compare)["accepted_changes"].dump(), HasSubstr("m/fits.json"));
  EXPECT_EQ(content_of(at("m/manifest.json")), manifest);
  EXPECT_EQ(verify.code, 2);
  EXPECT_THAT(one_object(verify)["changed"].dump(), HasSubstr("fits.json"));
}

TEST_F(ChangedSessions, AReplayOfOneSaysSoInTheNewSession) {
  change_a_digit("m/log.txt", 0.5);

  const Ended ended = run({"replay", "m", "--out", "r", "--accept-changed", "--json"});

  EXPECT_TRUE(completed(ended));
  EXPECT_EQ(one_object(ended)["accepted_changes"], Json({"log.txt"}));
  EXPECT_THAT(content_of(at("r/provenance.json")), HasSubstr("changed after its end: log.txt"));
  EXPECT_THAT(content_of(at("r/report.html")), HasSubstr("changed after its end: log.txt"));
  expect_whole_session(at("r"), "complete");
}

TEST_F(ChangedSessions, AReplayThatDiffersNamesTheAcceptedChange) {
  change_a_digit("m/trials.csv", 0.5);

  const Ended ended = run({"replay", "m", "--out", "r", "--accept-changed"});

  EXPECT_EQ(ended.code, 1);
  EXPECT_THAT(ended.err, HasSubstr("files of the session were changed, which --accept-changed accepted: trials.csv"));
  EXPECT_THAT(ended.err, ::testing::Not(HasSubstr("defect")));
}

TEST_F(ChangedSessions, WithoutAManifestAreChangedUnlessTheRunWasCutOff) {
  std::filesystem::remove(at("m/manifest.json"));
  expect_refused(run({"report", "m"}), 2, "manifest.json was removed after the session ended");
  expect_refused(run({"compare", "m", "other"}), 2, "manifest.json was removed");

  std::string provenance = content_of(at("m/provenance.json"));
  provenance.replace(provenance.find("\"complete\""), 10, "\"running\"");
  write("m/provenance.json", provenance);
  const Ended verify = run({"verify", "m", "--json"});
  const Ended report = run({"report", "m"});

  EXPECT_EQ(verify.code, 2);
  EXPECT_EQ(one_object(verify)["condition"], "cut_off");
  EXPECT_EQ(report.code, 0) << report.err;
  EXPECT_THAT(report.err, HasSubstr("cut off"));
  EXPECT_THAT(content_of(at("m/report.html")), HasSubstr("its files cannot be verified"));
  expect_refused(run(range_of_m), 2, "was cut off");
}

TEST_F(ChangedSessions, AnIntactOneGetsItsReportAgainAndStaysIntact) {
  const std::string before = content_of(at("m/report.html"));
  std::filesystem::remove(at("m/report.html"));

  ASSERT_EQ(run({"report", "m"}).code, 0);

  EXPECT_EQ(content_of(at("m/report.html")), before);
  EXPECT_THAT(before, Not(HasSubstr("FILES CHANGED")));
  const Ended verify = run({"verify", "m"});
  EXPECT_EQ(verify.code, 0) << verify.err;
  EXPECT_THAT(verify.out, HasSubstr("intact"));
}

TEST_F(ChangedSessions, ARangeAtTheSetContrastIsThatOfItsPoint) {
  const Json json = one_object(run(range_of_m));

  ASSERT_TRUE(json["r75_m"].is_number()) << json;
  const Json point = Json::parse(content_of(at("m/fits.json")))["main"]["points"][0];
  ASSERT_NE(point["delta_t_k"], 16.9);  // what the camera saw is not what the target was told
  const double s75 = point["fit"]["threshold"];
  EXPECT_NEAR(json["r75_m"].get<double>(), 1000 * 5 / (5.1 * s75), 1e-6);
}

TEST_F(ChangedSessions, WhereTheCurveDoesNotAnswerARangeIsOneSentence) {
  const std::vector<std::string> faint{"range", "--tod", "m", "--size-m", "5", "--delta-t-k", "0.01"};
  const Ended said = run(faint);
  std::vector<std::string> in_json = faint;
  in_json.emplace_back("--json");
  const Ended json = run(in_json);

  EXPECT_EQ(said.code, 3);
  EXPECT_THAT(said.out, AllOf(HasSubstr("below the lowest contrast of the TOD curve"), Not(HasSubstr("–"))));
  EXPECT_LE(lines_of(said.out).size(), 4u);
  EXPECT_EQ(json.code, 3);
  EXPECT_TRUE(one_object(json)["r75_m"].is_null());
  EXPECT_THAT(one_object(json)["curve"], IsEmpty());
}

TEST_F(ChangedSessions, ARevisionWhoseDigestWasKeptIsMissed) {
  ASSERT_TRUE(run_program({"openssl", "genpkey", "-algorithm", "ED25519", "-out", at("key.pem").string()},
                          ProgramOutput::kept));
  ASSERT_EQ(run({"sign", "m", "--with", "openssl", "--key", "key.pem"}).code, 0);
  EXPECT_THAT(run({"verify", "m"}).out, HasSubstr("revisions of the report: none"));
  const Json revised = one_object(run({"report", "m", "--reason", "a wrong name", "--key", "key.pem", "--json"}));
  const std::string digest = revised["revision_sha256"];
  EXPECT_THAT(run({"verify", "m"}).out,
              HasSubstr("revisions of the report: 1; the newest is revision 2, SHA-256 " + digest));
  EXPECT_EQ(one_object(run({"verify", "m", "--json"}))["signature"]["newest_revision_sha256"], digest);
  EXPECT_EQ(run({"verify", "m", "--expect-revision", digest}).code, 0);

  std::filesystem::remove_all(at("m") / "revisions");

  EXPECT_EQ(run({"verify", "m"}).code, 0) << "nothing in the folder shows it";
  const Ended missed = run({"verify", "m", "--expect-revision", digest});
  EXPECT_EQ(missed.code, 2);
  EXPECT_THAT(missed.err, HasSubstr("the revision with the SHA-256 " + digest + " is missing"));
}

}  // namespace
}  // namespace todbench::testing
