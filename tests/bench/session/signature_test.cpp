// SPDX-License-Identifier: GPL-3.0-or-later
// Signing and checking with the real programs.
#include "bench/session/signature.h"

#include <gmock/gmock.h>

#include <fstream>

#include "acquisition/base/process.h"
#include "bench/session/manifest.h"
#include "bench/session/open_session.h"
#include "bench/session/session_folder.h"
#include "bench/text/files.h"
#include "bench/text/json.h"
#include "tests/support/source_file.h"
#include "tests/support/temporary_folder.h"

namespace todbench {
namespace {

using testing::content_of;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::TemporaryFolder;

constexpr const char* utc = "2026-11-22T12:00:00Z";

void run(const std::vector<std::string>& words) {
  const auto done = run_program(words, ProgramOutput::kept);
  ASSERT_TRUE(done) << done.error().message;
  ASSERT_EQ(done->exit_code, 0) << done->output;
}

class Signature : public ::testing::TestWithParam<std::vector<std::string>> {
 protected:
  void SetUp() override {
    std::filesystem::copy(source_file("tests/golden/session-0.1"), session_, std::filesystem::copy_options::recursive);
    make_key("mine");
  }
  /// NAME.pem and NAME.pub.
  void make_key(const std::string& name, const std::vector<std::string>& kind = {"-algorithm", "ED25519"}) {
    const std::string key = (folder_.path() / (name + ".pem")).string();
    std::vector<std::string> words{"openssl", "genpkey"};
    words.insert(words.end(), kind.begin(), kind.end());
    words.insert(words.end(), {"-out", key});
    run(words);
    run({"openssl", "pkey", "-in", key, "-pubout", "-out", (folder_.path() / (name + ".pub")).string()});
  }
  [[nodiscard]] std::filesystem::path key(const std::string& name) const { return folder_.path() / name; }

  TemporaryFolder folder_;
  std::filesystem::path session_ = folder_.path() / "session";
};

TEST_P(Signature, HoldsForItsManifestAndKeyOnly) {
  make_key("mine", GetParam());
  make_key("other", GetParam());

  const auto made = sign_session(session_, SigningProgram::openssl, key("mine.pem"), utc);

  ASSERT_TRUE(made) << made.error().message;
  EXPECT_TRUE(check_session(session_)->files.intact());
  for (const std::optional<std::filesystem::path>& with :
       {std::optional<std::filesystem::path>(), std::optional(key("mine.pub"))}) {
    const auto check = check_signature(session_, with);
    ASSERT_TRUE(check && *check) << check.error().message;
    EXPECT_TRUE((*check)->valid) << (*check)->sentence;
    EXPECT_EQ((*check)->own_key, !with);
    EXPECT_EQ((*check)->signature.signed_utc, utc);
  }
  EXPECT_FALSE((*check_signature(session_, key("other.pub")))->valid);
  std::ofstream(session_ / manifest_name, std::ios::app) << " ";
  EXPECT_FALSE((*check_signature(session_, std::nullopt))->valid);
}
INSTANTIATE_TEST_SUITE_P(Kinds, Signature,
                         ::testing::Values(std::vector<std::string>{"-algorithm", "ED25519"},
                                           std::vector<std::string>{"-algorithm", "EC", "-pkeyopt",
                                                                    "ec_paramgen_curve:P-256"},
                                           std::vector<std::string>{"-algorithm", "RSA"}),
                         [](const auto& kind) { return kind.param[1]; });

using SignedSession = Signature;

TEST_F(SignedSession, IsNeverWrittenAgain) {
  ASSERT_TRUE(sign_session(session_, SigningProgram::openssl, key("mine.pem"), utc));

  EXPECT_EQ(refresh_manifest(session_, {"report.html"}).error().code, ErrorCode::invalid_input);
  EXPECT_EQ(require_intact(session_).error().code, ErrorCode::invalid_input);
  EXPECT_EQ(sign_session(session_, SigningProgram::openssl, key("mine.pem"), utc).error().code,
            ErrorCode::invalid_input);
  const auto again = SessionFolder::create(session_, ExistingFolder::overwrite);
  ASSERT_FALSE(again);
  EXPECT_THAT(again.error().message, HasSubstr("is signed"));
  EXPECT_TRUE((*check_signature(session_, std::nullopt))->valid);
}

TEST_F(SignedSession, HasRevisionsWithNumbersThatAreChecked) {
  EXPECT_FALSE(next_revision(session_, "a reason", utc));
  ASSERT_TRUE(sign_session(session_, SigningProgram::openssl, key("mine.pem"), utc));
  EXPECT_FALSE(next_revision(session_, " \n", utc));

  for (const int number : {2, 3}) {
    const auto revision = next_revision(session_, "a reason", utc);
    ASSERT_TRUE(revision) << revision.error().message;
    EXPECT_EQ(revision->number, number);
    std::filesystem::create_directories(session_ / "revisions");
    const std::string page = revision_page(*revision, "html");
    std::ofstream(session_ / page) << "page " << number;
    ASSERT_TRUE(keep_revision(session_, *revision, {page}, key("mine.pem")));
  }

  EXPECT_TRUE((*check_signature(session_, std::nullopt))->valid);
  EXPECT_TRUE(check_session(session_)->files.intact());
  std::ofstream(session_ / "revisions/report-2.html", std::ios::app) << "x";
  const auto check = check_signature(session_, std::nullopt);
  EXPECT_FALSE((*check)->valid);
  EXPECT_THAT((*check)->sentence, HasSubstr("revisions/report-2.html"));
}

TEST_F(SignedSession, AForgedRevisionIsSeenThoughItsDigestIsListed) {
  ASSERT_TRUE(sign_session(session_, SigningProgram::openssl, key("mine.pem"), utc));
  const auto revision = next_revision(session_, "a reason", utc);
  ASSERT_TRUE(revision);
  std::filesystem::create_directories(session_ / "revisions");
  const std::string page = revision_page(*revision, "html");
  const std::string pass = "<p>PASS</p>", failed = "<p>FAIL</p>";
  std::ofstream(session_ / page) << pass;
  ASSERT_TRUE(keep_revision(session_, *revision, {page}, key("mine.pem")));
  ASSERT_TRUE((*check_signature(session_, std::nullopt))->valid);
  EXPECT_THAT((*check_signature(session_, std::nullopt))->covers,
              ElementsAre("manifest.json", "signed_utc", "revisions"));

  std::ofstream(session_ / page) << failed;
  std::string list = content_of(session_ / "revisions/revisions.json");
  list.replace(list.find(sha256_of(pass)), 64, sha256_of(failed));
  std::ofstream(session_ / "revisions/revisions.json") << list;

  EXPECT_FALSE((*check_signature(session_, std::nullopt))->valid);
  EXPECT_FALSE(next_revision(session_, "another reason", utc)) << "it would sign the forged one";
}

TEST_F(SignedSession, ChainsItsRevisionsSoThatAKeptDigestShowsARemovedOne) {
  ASSERT_TRUE(sign_session(session_, SigningProgram::openssl, key("mine.pem"), utc));
  std::filesystem::create_directories(session_ / "revisions");
  std::vector<std::string> lists, signatures;
  for (int k = 0; k < 2; ++k) {
    const auto revision = next_revision(session_, "a reason", utc).value();
    const std::string page = revision_page(revision, "html");
    std::ofstream(session_ / page) << k;
    ASSERT_TRUE(keep_revision(session_, revision, {page}, key("mine.pem")));
    lists.push_back(content_of(session_ / "revisions/revisions.json"));
    signatures.push_back(content_of(session_ / "revisions/revisions.json.sig"));
  }
  const std::vector<std::string> digests = (*check_signature(session_, std::nullopt))->revision_sha256;
  ASSERT_EQ(digests.size(), 2u);
  const Json records = Json::parse(lists[1])["revisions"];
  EXPECT_EQ(records[0]["previous_sha256"], sha256_of(content_of(session_ / "signature.json")));
  EXPECT_EQ(records[1]["previous_sha256"], digests[0]);

  std::ofstream(session_ / "revisions/revisions.json") << lists[0];
  std::ofstream(session_ / "revisions/revisions.json.sig") << signatures[0];
  std::filesystem::remove(session_ / "revisions/report-3.html");
  const auto rolled_back = check_signature(session_, std::nullopt);
  EXPECT_TRUE((*rolled_back)->valid);
  EXPECT_THAT((*rolled_back)->revision_sha256, ElementsAre(digests[0]));
}

TEST_F(SignedSession, AListFromWhichARevisionWasTakenIsNotContinued) {
  ASSERT_TRUE(sign_session(session_, SigningProgram::openssl, key("mine.pem"), utc));
  std::filesystem::create_directories(session_ / "revisions");
  for (int k = 0; k < 2; ++k) {
    const auto revision = next_revision(session_, "a reason", utc).value();
    ASSERT_TRUE(keep_revision(session_, revision, {}, key("mine.pem")));
  }
  Json list = Json::parse(content_of(session_ / "revisions/revisions.json"));
  list["revisions"].erase(0);
  std::ofstream(session_ / "revisions/revisions.json") << to_page(list);

  EXPECT_FALSE(keep_revision(session_, {.number = 3, .utc = utc, .reason = "a reason"}, {}, key("mine.pem")));
}

TEST_F(SignedSession, ItsTimeIsSigned) {
  ASSERT_TRUE(sign_session(session_, SigningProgram::openssl, key("mine.pem"), utc));
  std::string record = content_of(session_ / "signature.json");
  record.replace(record.find(utc), 4, "2020");
  std::ofstream(session_ / "signature.json") << record;

  const auto check = check_signature(session_, key("mine.pub"));
  ASSERT_TRUE(check && *check);
  EXPECT_FALSE((*check)->valid);
  EXPECT_THAT((*check)->sentence, HasSubstr("time of signing"));
}

TEST_F(SignedSession, ARecordWithoutItsOwnSignatureIsRefused) {
  ASSERT_TRUE(sign_session(session_, SigningProgram::openssl, key("mine.pem"), utc));
  Json record = Json::parse(content_of(session_ / "signature.json"));
  record["schema"] = "todbench-signature-1";
  record.erase("manifest_file_sha256");
  record["signed_utc"] = "2020-01-01T00:00:00Z";
  std::filesystem::remove(session_ / "signature.json.sig");

  EXPECT_FALSE((*check_signature(session_, key("mine.pub")))->valid) << "its signature is missing";
  std::ofstream(session_ / "signature.json") << to_page(record);
  const auto downgraded = check_signature(session_, key("mine.pub"));
  ASSERT_FALSE(downgraded);
  EXPECT_EQ(downgraded.error().code, ErrorCode::invalid_input);
  EXPECT_THAT(downgraded.error().message, HasSubstr("todbench-signature-2"));
}

TEST_F(SignedSession, ItsRecordHasEveryKey) {
  const auto made = sign_session(session_, SigningProgram::openssl, key("mine.pem"), utc);
  ASSERT_TRUE(made) << made.error().message;
  const std::string written = content_of(session_ / "signature.json");
  EXPECT_EQ(written, to_page(Json{{"schema", "todbench-signature-2"},
                                  {"with", "openssl"},
                                  {"signed_utc", utc},
                                  {"manifest_sha256", made->manifest_sha256},
                                  {"manifest_file_sha256", made->manifest_file_sha256},
                                  {"key_sha256", made->key_sha256()},
                                  {"public_key", made->public_key}}));
  const auto mistake_of = [&](const Json& record) {
    std::ofstream(session_ / "signature.json") << to_page(record);
    const auto check = check_signature(session_, key("mine.pub"));
    return check ? std::string() : check.error().message;
  };
  for (const std::string name :
       {"schema", "with", "signed_utc", "manifest_sha256", "manifest_file_sha256", "public_key"}) {
    Json record = Json::parse(written);
    record[name] = nullptr;
    EXPECT_THAT(mistake_of(record), HasSubstr("signature.json: '" + name + "': expected a text"));
    record.erase(name);
    EXPECT_THAT(mistake_of(record), HasSubstr("signature.json: missing key '" + name + "'"));
  }
}

TEST_F(SignedSession, WhatNoSignatureListsIsForeign) {
  ASSERT_TRUE(sign_session(session_, SigningProgram::openssl, key("mine.pem"), utc));
  std::filesystem::create_directories(session_ / "revisions");
  std::ofstream(session_ / "revisions/report-2.html") << "FAIL";
  std::ofstream(session_ / "revisions/revisions.json")
      << R"({"schema": "todbench-revisions-1", "revisions": [{"number": 2, "utc": "", "reason": "", "pages": [{"path":)"
      << R"( "revisions/report-2.html", "sha256": ")" << sha256_of("FAIL") << R"("}]}]})";

  EXPECT_THAT(check_session(session_)->files.foreign,
              ElementsAre("revisions/report-2.html", "revisions/revisions.json"));
}

TEST_F(Signature, RevisionsOfASessionThatIsNotSignedAreForeign) {
  std::filesystem::create_directories(session_ / "revisions");
  std::ofstream(session_ / "revisions/report-2.html") << "FAIL";

  EXPECT_THAT(check_session(session_)->files.foreign, ElementsAre("revisions/report-2.html"));
}

TEST_F(SignedSession, IsSignedAgainByItsOwnKeyOnly) {
  make_key("other");
  ASSERT_TRUE(sign_session(session_, SigningProgram::openssl, key("mine.pem"), utc));

  EXPECT_TRUE(require_key_of_session(session_, key("mine.pem")));
  EXPECT_FALSE(require_key_of_session(session_, key("other.pem")));
}

TEST_F(SignedSession, IsRefusedWithOneSentence) {
  folder_.write("no.pem", "no key");
  const auto refused = sign_session(session_, SigningProgram::openssl, key("no.pem"), utc);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::invalid_input);
  EXPECT_EQ(refused.error().message.find('\n'), std::string::npos);
  EXPECT_EQ(sign_session(session_, SigningProgram::openssl, key("none.pem"), utc).error().code,
            ErrorCode::invalid_input);
  EXPECT_FALSE(is_signed(session_));
  EXPECT_TRUE(check_session(session_)->files.intact());
  std::ofstream(session_ / "trials.csv", std::ios::app) << "1\n";
  EXPECT_EQ(sign_session(session_, SigningProgram::openssl, key("mine.pem"), utc).error().code,
            ErrorCode::invalid_input);
}

TEST_F(SignedSession, MaySignWithMinisign) {
  if (!run_program({"minisign", "-v"}, ProgramOutput::kept)) GTEST_SKIP() << "minisign is not installed";
  run({"minisign", "-G", "-W", "-p", key("m.pub").string(), "-s", key("m.key").string()});

  const auto made = sign_session(session_, SigningProgram::minisign, key("m.key"), utc);

  ASSERT_TRUE(made) << made.error().message;
  EXPECT_TRUE((*check_signature(session_, key("m.pub")))->valid);
  EXPECT_TRUE((*check_signature(session_, std::nullopt))->valid);
}

TEST(RunProgram, SaysWhatIsNotInstalled) {
  const auto run = run_program({"no-such-program-anywhere"}, ProgramOutput::kept);
  ASSERT_FALSE(run);
  EXPECT_EQ(run.error().code, ErrorCode::not_found);
}

}  // namespace
}  // namespace todbench
