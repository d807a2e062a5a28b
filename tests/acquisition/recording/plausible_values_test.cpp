// SPDX-License-Identifier: GPL-3.0-or-later
// Statements about a file that contradict its first frame.
#include "acquisition/recording/plausible_values.h"

#include <gmock/gmock.h>
#include <tiffio.h>

#include <chrono>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "acquisition/base/rng.h"
#include "acquisition/recording/recording_backend.h"
#include "tests/support/source_file.h"
#include "tests/support/temporary_folder.h"

namespace todbench {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr int side = 40;

/// A left and a right half with noise of 10 counts, seed 3; values modulo 2^16.
cv::Mat1w scene(int left, int right) {
  const RandomStream noise(3, "plausible values");
  cv::Mat1w counts(side, side);
  std::uint64_t k = 0;
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      const double value = (x < side / 2 ? left : right) + 10 * noise.normal(k++);
      counts(y, x) = static_cast<ushort>(static_cast<int>(std::lround(value)));
    }
  }
  return counts;
}

std::string bytes_of(const cv::Mat1w& counts) {
  std::string bytes;
  for (const ushort count : counts) bytes += {static_cast<char>(count & 255), static_cast<char>(count >> 8)};
  return bytes;
}

const std::string size = "width=40&height=40";

/// What opening the scene as a raw file gives: the error, or the warnings.
std::string raw_message(const cv::Mat1w& counts, const std::string& more) {
  const TemporaryFolder folder;
  const auto recording = open_recording(folder.write("a.raw", bytes_of(counts)), size + more);
  if (!recording) return recording.error().code == ErrorCode::invalid_input ? recording.error().message : "wrong code";
  std::string all;
  for (const auto& warning : recording->info.warnings) all += warning;
  return all;
}

void write_floats(const std::filesystem::path& path, const cv::Mat1f& page) {
  TIFF* tiff = TIFFOpen(path.c_str(), "w");
  for (const auto& [tag, value] : {std::pair{TIFFTAG_IMAGEWIDTH, page.cols},
                                   {TIFFTAG_IMAGELENGTH, page.rows},
                                   {TIFFTAG_BITSPERSAMPLE, 32},
                                   {TIFFTAG_SAMPLESPERPIXEL, 1},
                                   {TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_IEEEFP},
                                   {TIFFTAG_ROWSPERSTRIP, page.rows},
                                   {TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK}})
    TIFFSetField(tiff, static_cast<std::uint32_t>(tag), value);
  for (int y = 0; y < page.rows; ++y)
    TIFFWriteScanline(tiff, const_cast<float*>(page.ptr<float>(y)), static_cast<std::uint32_t>(y), 0);
  TIFFClose(tiff);
}

TEST(PlausibleValues, SignedValuesReadAsUnsignedNeedAStatement) {
  const cv::Mat1w around_zero = scene(-60, 80);

  EXPECT_THAT(raw_message(around_zero, ""), AllOf(HasSubstr("a.raw"), HasSubstr("state signed=yes")));
  EXPECT_THAT(raw_message(around_zero, "&signed=no"), HasSubstr("check signed=no"));
  EXPECT_THAT(raw_message(around_zero, "&signed=yes"), IsEmpty());
}

TEST(PlausibleValues, UnsignedValuesReadAsSignedAreNamedIfTheyCrossHalfTheRange) {
  const cv::Mat1w around_half = scene(32700, 32840), below_half = scene(8000, 8140);

  EXPECT_THAT(raw_message(around_half, "&signed=yes"), HasSubstr("remove signed=yes"));
  EXPECT_THAT(raw_message(around_half, ""), IsEmpty());
  EXPECT_THAT(raw_message(below_half, "&signed=yes"), IsEmpty());
}

TEST(PlausibleValues, ScenesWithHotOrClippedPartsDoNotLookWrapped) {
  cv::Mat1w clipped = scene(100, 65000);
  for (auto& count : clipped) count = count < 32768 ? ushort{0} : ushort{65535};

  EXPECT_FALSE(looks_wrapped(scene(1000, 60000)));
  EXPECT_FALSE(looks_wrapped(clipped));
  EXPECT_FALSE(looks_wrapped(cv::Mat1w(side, side, ushort{7})));
  EXPECT_TRUE(looks_wrapped(scene(0, 3)));
}

TEST(PlausibleValues, RealRecordingsPassInTheirFormat) {
  for (const char* name : {"lepton_a_160x120_u16le.raw", "lepton_b_160x120_u16le.raw"}) {
    const auto recording = open_recording(source_file("tests/golden/real/") + name, "width=160&height=120&bits=14");
    ASSERT_TRUE(recording) << recording.error().message;
    EXPECT_THAT(recording->info.warnings, IsEmpty());
    EXPECT_TRUE(recording->read(recording->frame_count - 1));
  }
}

TEST(PlausibleValues, CountsAboveTheStatedBitsAreRefusedInEveryFrame) {
  const TemporaryFolder folder;
  const cv::Mat1w low = scene(500, 900), high = scene(500, 4200);
  const auto path = folder.write("a.raw", bytes_of(low) + bytes_of(high));

  const auto later = open_recording(path, size + "&bits=10"), whole = open_recording(path, size + "&bits=14");

  ASSERT_TRUE(later) << later.error().message;
  EXPECT_TRUE(later->read(0));
  EXPECT_EQ(later->read(1).error().code, ErrorCode::invalid_input);
  EXPECT_THAT(later->read(1).error().message, HasSubstr("bits=10 is stated, but a count is 42"));
  ASSERT_TRUE(whole);
  EXPECT_TRUE(whole->read(1));
  EXPECT_THAT(raw_message(high, "&bits=12"), HasSubstr("12 bits end at 4095"));
  EXPECT_THAT(raw_message(low, "&bits=14&signed=yes"), HasSubstr("remove bits"));
}

TEST(PlausibleValues, AReadErrorIsNotTheEndOfTheRecording) {
  const TemporaryFolder folder;
  const auto path = folder.write("a.raw", bytes_of(scene(500, 900)) + bytes_of(scene(500, 4200)));
  const auto source = recording_backend()->open("file:" + path.string() + "?" + size + "&bits=10");
  ASSERT_TRUE(source && (*source)->start());
  ASSERT_TRUE((*source)->next(std::chrono::seconds(1)));

  const auto frame = (*source)->next(std::chrono::seconds(1));

  ASSERT_FALSE(frame);
  EXPECT_EQ(frame.error().code, ErrorCode::invalid_input);
}

TEST(PlausibleValues, ScalesThatGiveNoTemperatureOfASceneAreNamed) {
  const cv::Mat1w around_zero = scene(-60, 80), kelvin = scene(29500, 29600);

  EXPECT_THAT(raw_message(around_zero, "&signed=yes&kelvin_per_count=0.01"),
              AllOf(HasSubstr("below absolute zero"), HasSubstr("offset_k, the temperature of the value 0 in kelvin")));
  EXPECT_THAT(raw_message(around_zero, "&signed=yes&kelvin_per_count=0.01&offset_k=21"),
              HasSubstr("outside 150 to 2000 K"));
  EXPECT_THAT(raw_message(around_zero, "&signed=yes&kelvin_per_count=0.01&offset_k=294"), IsEmpty());
  EXPECT_THAT(raw_message(kelvin, "&kelvin_per_count=0.01"), IsEmpty());
  EXPECT_THAT(raw_message(kelvin, "&kelvin_per_count=0.1"), HasSubstr("outside 150 to 2000 K"));
}

TEST(PlausibleValues, TemperaturesInTheOtherUnitAreNamed) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "t.tif";
  const auto warnings = [&](float level, const std::string& unit) {
    cv::Mat1f page;
    scene(0, 100).convertTo(page, CV_32F, 0);
    page += level;
    page(cv::Rect(0, 0, 5, 5)) += 3;
    write_floats(path, page);
    const auto recording = open_recording(path, "unit=" + unit);
    return recording ? recording->info.warnings : std::vector<std::string>{recording.error().message};
  };

  EXPECT_THAT(warnings(22, "kelvin"), ElementsAre(HasSubstr("state unit=celsius if the values are degrees Celsius")));
  EXPECT_THAT(warnings(-20, "kelvin"), ElementsAre(HasSubstr("state unit=celsius")));
  EXPECT_THAT(warnings(295, "celsius"), ElementsAre(HasSubstr("state unit=kelvin if the values are kelvin")));
  EXPECT_THAT(warnings(295, "kelvin"), IsEmpty());
  EXPECT_THAT(warnings(22, "celsius"), IsEmpty());
  EXPECT_THAT(warnings(500, "celsius"), IsEmpty());
}

}  // namespace
}  // namespace todbench
