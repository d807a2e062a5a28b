// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/base/safe_text.h"

#include <gmock/gmock.h>

#include <string>

namespace todbench {
namespace {

constexpr const char* lost = "\xEF\xBF\xBD";

TEST(SafeText, LeavesTextOfEveryScriptAsItIs) {
  const std::string text = "ΔT 0.1 K – Wärmebild 热像仪 \xF0\x9F\x94\xA5, a\tb\nc";

  EXPECT_EQ(valid_text(text), text);
  EXPECT_EQ(one_line(text), "ΔT 0.1 K – Wärmebild 热像仪 \xF0\x9F\x94\xA5, a b c");
}

TEST(SafeText, TakesWhatSteersATerminalOut) {
  EXPECT_EQ(one_line("a\x1b[2Jb\x07"
                     "c\x7f"),
            "a [2Jb c ");
  EXPECT_EQ(valid_text("a\x1b[2Jb"), "a" + std::string(lost) + "[2Jb");
  for (const std::string steering : {"\xC2\x9B", "\xC2\x80", "\xE2\x80\xAE", "\xE2\x81\xA6", "\xE2\x80\x8F", "\xD8\x9C",
                                     "\xE2\x80\xA8", "\xEF\xBB\xBF"}) {
    EXPECT_EQ(valid_text("a" + steering + "b"), "a" + std::string(lost) + "b");
    EXPECT_EQ(one_line("a" + steering + "b"), "a" + std::string(lost) + "b");
  }
}

TEST(SafeText, ReplacesEveryByteThatIsNoCharacter) {
  // Alone, cut off, not the shortest form, a surrogate, beyond the last one.
  for (const std::string broken : {"\x9B", "\xFF", "\xE2\x80", "\xC0\xAF", "\xED\xA0\x80", "\xF4\x90\x80\x80"}) {
    std::string expected = "a";
    for (std::size_t i = 0; i < broken.size(); ++i) expected += lost;
    EXPECT_EQ(valid_text("a" + broken + "b"), expected + "b");
  }
}

TEST(SafeText, EveryByteAloneComesOutWithoutASteeringOne) {
  for (int byte = 0; byte < 256; ++byte) {
    const std::string line = one_line(std::string(1, static_cast<char>(byte)));
    for (const char c : line) EXPECT_FALSE(static_cast<unsigned char>(c) < 0x20 || c == 0x7f) << byte;
  }
}

TEST(SafeText, ALongLineEndsInAnEllipsis) {
  EXPECT_EQ(one_line("abcdef", 6), "abcdef");
  EXPECT_EQ(one_line("abcdefg", 6), "abcdef…");
  EXPECT_EQ(one_line(std::string(1000000, 'x')).size(), longest_shown_line + 3);
}

TEST(SafeText, JsonKeepsTheCharactersAsEscapes) {
  EXPECT_EQ(escaped_json("{\"ΔT\": \"a\x7f\xC2\x9B\xE2\x80\xAE\"}"), "{\"ΔT\": \"a\\u007f\\u009b\\u202e\"}");
}

}  // namespace
}  // namespace todbench
