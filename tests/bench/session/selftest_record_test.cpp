// SPDX-License-Identifier: GPL-3.0-or-later
// The result of the last self-test, as later sessions state it.
#include "bench/session/selftest_record.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "bench/session/provenance.h"
#include "bench/text/text.h"
#include "tests/support/temporary_folder.h"

namespace todbench {
namespace {

using ::testing::HasSubstr;

SelftestRecord of_112_cases() {
  SelftestRecord record;
  record.passed = 111, record.failed = 1;
  record.cases_sha256 = std::string(64, 'a');
  return record;
}

TEST(SelftestRecord, IsReadByTheProgramAndComputerThatWroteIt) {
  const testing::TemporaryFolder folder;
  const auto file = folder.path() / "state" / "selftest.json";

  EXPECT_FALSE(kept_selftest(file));
  ASSERT_TRUE(keep_selftest(file, of_112_cases()));
  const auto kept = kept_selftest(file);

  ASSERT_TRUE(kept);
  EXPECT_EQ(kept->passed, 111);
  EXPECT_EQ(kept->failed, 1);
  EXPECT_THAT(in_words(*kept), HasSubstr("111 of 112 cases on 2"));
}

TEST(SelftestRecord, OfAnotherProgramComputerOrContentIsNone) {
  const testing::TemporaryFolder folder;
  const auto file = folder.path() / "selftest.json";
  ASSERT_TRUE(keep_selftest(file, of_112_cases()));
  const std::string text = read_text_file(file).value();
  const Json json = Json::parse(text);
  for (const char* key : {"program_version", "git_commit", "compiler", "host"}) {
    Json other = json;
    other[key] = "another";
    std::ofstream(file) << other.dump();
    EXPECT_FALSE(kept_selftest(file)) << key;
  }
  for (const std::string& content : {std::string(), std::string("{}"), text.substr(0, text.size() / 2)}) {
    std::ofstream(file) << content;
    EXPECT_FALSE(kept_selftest(file)) << content;
  }
}

TEST(SelftestRecord, IsPartOfTheProvenance) {
  Provenance provenance = begin_provenance(Plan{}, Side::measured);
  EXPECT_FALSE(provenance_json(provenance)->contains("selftest"));
  provenance.selftest = of_112_cases();

  const auto read = provenance_from(*provenance_json(provenance));

  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->selftest, provenance.selftest);
}

}  // namespace
}  // namespace todbench
