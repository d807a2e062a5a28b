// SPDX-License-Identifier: GPL-3.0-or-later
// The letterhead of a laboratory on reports.
#include "bench/plan/letterhead.h"

#include <gmock/gmock.h>
#include <zlib.h>

#include <fstream>

#include "bench/report/html.h"
#include "bench/report/report.h"
#include "tests/bench/report/report_sample.h"
#include "tests/support/temporary_folder.h"

namespace todbench {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::string big_endian_text(std::uint32_t value) {
  std::string text;
  for (int shift = 24; shift >= 0; shift -= 8) text += static_cast<char>(value >> shift & 0xff);
  return text;
}

std::string chunk(const std::string& type, const std::string& data) {
  const std::string body = type + data;
  const auto sum = ::crc32(0, reinterpret_cast<const Bytef*>(body.data()), static_cast<uInt>(body.size()));
  return big_endian_text(static_cast<std::uint32_t>(data.size())) + body +
         big_endian_text(static_cast<std::uint32_t>(sum));
}

/// A black picture of 8 bits; `rows` of them, which may not be those that the header says.
std::string png_of(std::uint32_t width, std::uint32_t height, std::uint32_t rows, const std::string& more = "") {
  const std::string plain(std::size_t{rows} * (width + 1), '\0');
  uLongf size = ::compressBound(plain.size());
  std::string packed(size, '\0');
  ::compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(plain.data()),
             plain.size());
  packed.resize(size);
  const std::string header = big_endian_text(width) + big_endian_text(height) + std::string("\x08\x00\x00\x00\x00", 5);
  return "\x89PNG\r\n\x1a\n" + chunk("IHDR", header) + more + chunk("IDAT", packed) + chunk("IEND", "");
}

class LetterheadTest : public ::testing::Test {
 protected:
  Result<Letterhead> loaded(const std::string& text) {
    std::ofstream(folder_.path() / "lab.toml") << text;
    return load_letterhead(folder_.path() / "lab.toml");
  }
  void write_logo(const std::string& bytes) { std::ofstream(folder_.path() / "logo.png", std::ios::binary) << bytes; }

  testing::TemporaryFolder folder_;
};

TEST(LetterheadPng, KeepsThePictureAndNothingElse) {
  const std::string hidden = chunk("tEXt", std::string("Comment\0<script>alert(1)</script>", 32));

  const auto png = checked_png(png_of(20, 10, 10, hidden));

  ASSERT_TRUE(png) << png.error().message;
  EXPECT_EQ(*png, png_of(20, 10, 10));
}

TEST(LetterheadPng, RefusesWhatIsNoneOrTooLarge) {
  std::string torn = png_of(20, 10, 10);
  torn.resize(torn.size() - 20);
  std::string flipped = png_of(20, 10, 10);
  flipped[40] ^= 1;
  for (const std::string& wrong :
       {std::string(), std::string("<svg/>"), torn, flipped, png_of(20, 10, 9), png_of(20, 10, 11), png_of(2001, 1, 1),
        png_of(1, 2001, 2001), png_of(0, 10, 10), png_of(20, 10, 10).substr(0, 8),
        png_of(20, 10, 10, chunk("tEXt", std::string(600'000, 'x')))}) {
    const auto png = checked_png(wrong);

    ASSERT_FALSE(png) << wrong.size();
    EXPECT_EQ(png.error().code, ErrorCode::invalid_input);
  }
}

TEST_F(LetterheadTest, StandsOnTheReportAndTakesNothingAway) {
  write_logo(png_of(20, 10, 10));
  const auto letterhead = loaded(
      "title = \"Acceptance <b>test</b>\"\nlogo = \"logo.png\"\nlogo_text = \"A \\\"lab\\\"\"\nlines = [\"Lab & "
      "Sons\"]\n"
      "introduction = [\"First <script>alert(1)</script>\"]\nclosing_title = \"Words\"\nclosing = [\"Last\"]\nfoot = "
      "\"L-1\"\n");
  ASSERT_TRUE(letterhead) << letterhead.error().message;
  ReportData data = sample_report();
  const Document without = report_document(data);
  data.letterhead = *letterhead;

  const Document with = report_document(data);
  const std::string page = render_html(with);

  EXPECT_THAT(page, HasSubstr("data:image/png;base64,iVBORw0KGgo"));
  EXPECT_THAT(page, HasSubstr("Lab &amp; Sons"));
  EXPECT_THAT(page, Not(HasSubstr("<script")));
  EXPECT_THAT(page, Not(HasSubstr("<b>test")));
  EXPECT_THAT(page, HasSubstr("Words"));
  EXPECT_THAT(with.page_label, ::testing::StartsWith("L-1 · "));
  ASSERT_EQ(with.opening.size(), without.opening.size() + 1);
  EXPECT_TRUE(std::holds_alternative<VerdictBox>(with.opening.back())) << "the verdict stays";
  EXPECT_EQ(with.sections.size(), without.sections.size() + 1);
}

TEST_F(LetterheadTest, IsKeptByASession) {
  write_logo(png_of(20, 10, 10));
  const auto letterhead =
      loaded("logo = \"logo.png\"\nlogo_text = \"A\"\nlogo_height_mm = 20\nlines = [\"a \\\"b\\\"\"]\n");
  ASSERT_TRUE(letterhead) << letterhead.error().message;
  const auto session = folder_.path() / "session";
  std::filesystem::create_directory(session);
  EXPECT_FALSE(kept_letterhead(session).value());

  const auto files = keep_letterhead(session, *letterhead);

  ASSERT_TRUE(files) << files.error().message;
  EXPECT_EQ(files->size(), 2U);
  EXPECT_EQ(kept_letterhead(session).value(), *letterhead);
}

TEST_F(LetterheadTest, IsReadStrictly) {
  write_logo(png_of(20, 10, 10));
  for (const std::string& wrong :
       {std::string("titel = \"x\"\n"), std::string("logo = \"logo.png\"\n"),
        std::string("logo = \"http://example.org/logo.png\"\nlogo_text = \"x\"\n"),
        std::string("logo = \"none.png\"\nlogo_text = \"x\"\n"), std::string("logo = \".\"\nlogo_text = \"x\"\n"),
        std::string("logo = \"lab.toml\"\nlogo_text = \"x\"\n"), std::string("lines = \"one\"\n"),
        std::string("lines = [\"two\\nlines\"]\n"), std::string("closing = [\"x\"]\n"),
        std::string("logo_height_mm = nan\n"), "foot = \"" + std::string(81, 'x') + "\"\n",
        "title = \"" + std::string(2001, 'x') + "\"\n", std::string("logo = [1]\n")}) {
    const auto letterhead = loaded(wrong);

    ASSERT_FALSE(letterhead) << wrong;
    EXPECT_EQ(letterhead.error().code, ErrorCode::invalid_input) << letterhead.error().message;
  }
}

}  // namespace
}  // namespace todbench
