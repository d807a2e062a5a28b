// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/base/result.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "acquisition/base/try.h"

namespace todbench {
namespace {

const Error about_a_key{ErrorCode::invalid_input, "plan.toml:3: key 'seed': too large",
                        ErrorKey{"run.seed", "too large"}};

TEST(Error, StaysAboutItsKeyWhereverItGoes) {
  const Result<int> far = fail("reading the plan", with_context("opening a session", about_a_key));

  ASSERT_FALSE(far);
  EXPECT_EQ(far.error().code, ErrorCode::invalid_input);
  EXPECT_EQ(far.error().message, "reading the plan: opening a session: plan.toml:3: key 'seed': too large");
  EXPECT_EQ(far.error().key, about_a_key.key);
}

TEST(Error, ChangesItsCodeAndNothingElse) {
  const Error other = with_code(ErrorCode::not_found, about_a_key);

  EXPECT_EQ(other.code, ErrorCode::not_found);
  EXPECT_EQ(other.message, about_a_key.message);
  EXPECT_EQ(other.key, about_a_key.key);
}

TEST(Error, IsSaidUnderTheNameThatTheUserKnows) {
  const Error said = renamed(about_a_key, "--seed");

  EXPECT_EQ(said.message, "--seed: too large");
  EXPECT_EQ(said.key, (ErrorKey{"--seed", "too large"}));
}

TEST(Error, IsRenamedByItsKeyWhateverItsMessageSays) {
  Error reworded = about_a_key;
  reworded.message = "something else altogether";

  EXPECT_EQ(renamed(reworded, "--seed").message, "--seed: too large");
}

TEST(Error, AboutAKeyNamesItInItsMessage) {
  const Result<int> failed = fail_at(ErrorCode::io, "fits.json", "cannot be read");

  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error().message, "fits.json: cannot be read");
  EXPECT_EQ(failed.error().key, (ErrorKey{"fits.json", "cannot be read"}));
}

Result<std::unique_ptr<int>> owned(int value) {
  if (value < 0) return fail_at(ErrorCode::invalid_input, "value", "negative");
  return std::make_unique<int>(value);
}

Result<std::string> joined(int first, int second) {
  std::string text;
  TODBENCH_TRY(const std::unique_ptr<int> one, owned(first));
  TODBENCH_TRY(text, [](int low, int high) -> Result<std::string> { return std::to_string(low + high); }(0, *one));
  if (second != 0) {
    TODBENCH_TRY(auto other, owned(second));
    text += "," + std::to_string(*other);
  }
  return text;
}

TEST(Try, GivesTheValueToAVariableOrAMember) {
  EXPECT_EQ(joined(3, 0).value(), "3");
  EXPECT_EQ(joined(3, 4).value(), "3,4");
}

TEST(Try, ReturnsTheFirstErrorWithItsCodeAndKey) {
  for (const auto& [first, second] : {std::pair(-1, 4), std::pair(3, -1)}) {
    const Result<std::string> failed = joined(first, second);

    ASSERT_FALSE(failed);
    EXPECT_EQ(failed.error().code, ErrorCode::invalid_input);
    EXPECT_EQ(failed.error().message, "value: negative");
    EXPECT_EQ(failed.error().key, (ErrorKey{"value", "negative"}));
  }
}

}  // namespace
}  // namespace todbench
