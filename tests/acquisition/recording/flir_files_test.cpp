// SPDX-License-Identifier: GPL-3.0-or-later
// Files of FLIR cameras: CSQ, SEQ, FFF and radiometric JPEG, whole, damaged and hostile; and files by their content.
#include <charls/charls.h>
#include <gmock/gmock.h>

#include <cmath>
#include <string>
#include <vector>

#include "acquisition/compression/compressed_picture.h"
#include "acquisition/recording/flir_seq.h"
#include "acquisition/recording/recording_backend.h"
#include "bench/picture_files/encoded_picture.h"
#include "tests/support/flir_file.h"
#include "tests/support/temporary_folder.h"

namespace todbench {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using namespace testing;

constexpr int flir_width = 40, flir_height = 30;

/// A smooth scene with some noise; the low byte varies, the high one is smooth.
cv::Mat1w flir_scene(int index) {
  cv::Mat1w counts(flir_height, flir_width);
  for (int y = 0; y < counts.rows; ++y) {
    for (int x = 0; x < counts.cols; ++x)
      counts(y, x) = static_cast<ushort>(18000 + 3 * x + 7 * y + x * y * 7919 % 61 + 11 * index);
  }
  return counts;
}

cv::Mat1w exchanged(cv::Mat1w counts) {
  for (auto& count : counts) count = static_cast<ushort>(count << 8 | count >> 8);
  return counts;
}

std::string jpeg_ls_of(const cv::Mat1w& counts, int near_lossless = 0) {
  charls::jpegls_encoder encoder;
  encoder.frame_info({static_cast<std::uint32_t>(counts.cols), static_cast<std::uint32_t>(counts.rows), 16, 1});
  encoder.near_lossless(near_lossless);
  std::string bytes(encoder.estimated_destination_size(), '\0');
  encoder.destination(bytes);
  bytes.resize(encoder.encode(counts.data, counts.total() * 2));
  return bytes;
}

std::string record_with(const std::string& pixels, std::uint64_t time_ms = 1'339'617'128'699,
                        const FlirFileCamera& camera = {}) {
  return flir_record(flir_camera_info(camera, time_ms), flir_raw_data(flir_width, flir_height, pixels));
}

void expect_counts(const Recording& recording, std::uint64_t index, const cv::Mat1w& expected) {
  const auto frame = recording.read(index);
  ASSERT_TRUE(frame) << frame.error().message;
  ASSERT_EQ(frame->counts.size(), expected.size());
  EXPECT_EQ(cv::norm(frame->counts, expected, cv::NORM_INF), 0) << index;
}

std::string refused(const std::filesystem::path& file) {
  const auto recording = open_recording(file, "");
  if (!recording) {
    EXPECT_EQ(recording.error().code, ErrorCode::invalid_input) << recording.error().message;
    return recording.error().message;
  }
  const auto frame = recording->read(0);
  return frame ? "read" : frame.error().message;
}

TEST(FlirFiles, InCsqHaveTheCountsThatWereCompressedAndTheConstantsOfTheCamera) {
  const TemporaryFolder folder;
  std::string content;
  for (int k = 0; k < 3; ++k)
    content += record_with(jpeg_ls_of(flir_scene(k)), 1'339'617'128'699 + 33 * static_cast<unsigned>(k));
  const auto file = folder.write("a.csq", content);

  const auto recording = open_recording(file, "");

  ASSERT_TRUE(recording) << recording.error().message;
  ASSERT_EQ(recording->frame_count, 3u);
  for (const std::uint64_t k : {2U, 0U, 1U}) expect_counts(*recording, k, flir_scene(static_cast<int>(k)));
  EXPECT_EQ(recording->read(1)->device_time_ns - recording->read(0)->device_time_ns, 33'000'000);
  const SourceInfo& info = recording->info;
  EXPECT_EQ(info.model, "FLIR SC660");
  EXPECT_EQ(info.serial, "404003980");
  EXPECT_EQ(info.frame_rate_hz, 30);
  EXPECT_EQ(info.settings.at("RawThermalImageType"), "JPEG-LS");
  EXPECT_EQ(info.settings.at("PlanckR2"), "0.012545258");
  EXPECT_EQ(info.settings.at("LensModel"), "FOL38");
  EXPECT_EQ(info.settings.at("DateTimeOriginal"), "2012-06-13T19:52:08.699Z");
  EXPECT_THAT(info.warnings, IsEmpty());
  // FLIR's formula with its constants of single precision: 1e-6 of the temperature.
  const double published = 1501 / std::log(21106.77 / (0.012545258 * (18816.0 - 7340)) + 1);
  EXPECT_NEAR(info.scale.kelvin(18816).value(), published, 1e-6 * published);
}

// As a T1030sc compresses: with errors of up to 5 counts.
TEST(FlirFiles, ThatWereCompressedWithLossesSayByHowMuch) {
  const TemporaryFolder folder;

  const auto recording = open_recording(folder.write("a.csq", record_with(jpeg_ls_of(flir_scene(0), 5))), "");

  ASSERT_TRUE(recording) << recording.error().message;
  EXPECT_EQ(recording->info.settings.at("LargestCompressionError"), "5");
  EXPECT_THAT(recording->info.warnings, ElementsAre(HasSubstr("a count may be off by 5")));
  const double off = cv::norm(recording->read(0)->counts, flir_scene(0), cv::NORM_INF);
  EXPECT_GT(off, 0);
  EXPECT_LE(off, 5);
}

// The sample of a T1030sc has frames of 5 to 20 counts.
TEST(FlirFiles, StateTheLargestErrorOfAllTheirFrames) {
  const TemporaryFolder folder;
  for (const auto& [first, second] : {std::pair(5, 20), std::pair(20, 5), std::pair(0, 16)}) {
    const std::string content =
        record_with(jpeg_ls_of(flir_scene(0), first)) + record_with(jpeg_ls_of(flir_scene(1), second));

    const auto recording = open_recording(folder.write("a.csq", content), "");

    ASSERT_TRUE(recording) << recording.error().message;
    EXPECT_EQ(recording->info.settings.at("LargestCompressionError"), std::to_string(std::max(first, second)));
    EXPECT_EQ(recording->info.warnings.size(), 1u);
  }
}

TEST(FlirFiles, SayThatObjectParametersAreNotApplied) {
  const TemporaryFolder folder;
  FlirFileCamera camera;
  camera.emissivity = 0.95F;
  camera.distance_m = 1;

  const auto recording = open_recording(folder.write("a", record_with(raw_pixels(flir_scene(0)), 1, camera)), "");

  ASSERT_TRUE(recording) << recording.error().message;
  EXPECT_THAT(recording->info.warnings,
              ElementsAre(AllOf(HasSubstr("ObjectEmissivity = 0.95, ObjectDistance = 1"), HasSubstr("are not"))));
}

TEST(FlirFiles, SayWhichObjectParametersAnyFrameHas) {
  const TemporaryFolder folder;
  FlirFileCamera later;
  later.emissivity = 0.5F;
  const std::string content = record_with(raw_pixels(flir_scene(0)), 1000) +
                              record_with(raw_pixels(flir_scene(1)), 1033, later) +
                              record_with(raw_pixels(flir_scene(2)), 1066);

  const auto recording = open_recording(folder.write("a.seq", content), "");

  ASSERT_TRUE(recording) << recording.error().message;
  EXPECT_EQ(recording->frame_count, 3u);
  EXPECT_THAT(recording->info.warnings, ElementsAre(HasSubstr("ObjectEmissivity = 0.5 to 1")));
}

TEST(FlirFiles, WhoseClockGoesBackOrLeavesGapsSaySo) {
  const TemporaryFolder folder;
  const auto with_times = [&](const std::vector<std::uint64_t>& times_ms) {
    std::string content;
    for (const auto time_ms : times_ms) content += record_with(raw_pixels(flir_scene(0)), time_ms);
    const auto recording = open_recording(folder.write("a.seq", content), "");
    return recording ? recording->info.warnings : std::vector<std::string>{recording.error().message};
  };

  EXPECT_THAT(with_times({1000, 1033, 1067, 1100, 1133}), IsEmpty());
  EXPECT_THAT(with_times({1000, 1000, 1000}), IsEmpty());
  EXPECT_THAT(with_times({1100, 1067, 1033, 1000}),
              ElementsAre(HasSubstr("the clock of the camera goes back at 3 of 3")));
  EXPECT_THAT(with_times({1000, 1033, 1100, 1133, 1167}),
              ElementsAre(AllOf(HasSubstr("usual time between two frames is 0.034 s"), HasSubstr("1 of 4"),
                                HasSubstr("up to 0.067 s"))));
}

TEST(FlirFiles, WithoutPlausibleTemperaturesSaySo) {
  const TemporaryFolder folder;
  FlirFileCamera camera;
  camera.b = 1501e6F;

  const auto recording = open_recording(folder.write("a.seq", record_with(raw_pixels(flir_scene(0)), 1, camera)), "");

  ASSERT_TRUE(recording) << recording.error().message;
  EXPECT_THAT(recording->info.warnings, ElementsAre(HasSubstr("the scale in the file may be wrong")));
}

TEST(FlirFiles, WhoseIndexJoinsTwoFramesAreRefused) {
  const TemporaryFolder folder;
  const std::string record = record_with(raw_pixels(flir_scene(0))), other = record_with(raw_pixels(flir_scene(1)));
  constexpr std::size_t camera_entry = 64, raw_entry = 96, length_in_entry = 16, offset_in_entry = 12;
  const auto changed = [&](std::size_t at, std::uint64_t value, std::size_t length) {
    std::string first = record;
    put(first, at, value, length);
    return folder.write("hostile.seq", first + other + other);
  };

  // The pixels of the next record.
  EXPECT_THAT(refused(changed(raw_entry + offset_in_entry, 128 + 0x470 + record.size(), 4)),
              HasSubstr("contains another record"));
  // A block of an unknown type over the next record.
  std::string with_third = record;
  put(with_third, 28, 3, 4);
  std::string third(32, '\0');
  put(third, 0, 0x77, 2);
  put(third, offset_in_entry, record.size() + third.size(), 4);
  put(third, length_in_entry, other.size(), 4);
  for (const std::size_t entry : {camera_entry, raw_entry})
    put(with_third, entry + offset_in_entry, (entry == camera_entry ? 128 : 128 + 0x470) + third.size(), 4);
  with_third.insert(128, third);
  EXPECT_THAT(refused(folder.write("covered.seq", with_third + other + other)), HasSubstr("contains another record"));
  // Two blocks of pixels.
  put(with_third, 128, 1, 2);
  EXPECT_THAT(refused(folder.write("two.seq", with_third + other + other)), HasSubstr("two blocks of pixels"));
}

TEST(FlirFiles, WhoseCompressedPixelsCoverTheNextRecordAreRefused) {
  const TemporaryFolder folder;
  const std::string next = record_with(jpeg_ls_of(flir_scene(1)));

  EXPECT_THAT(refused(folder.write("a.csq", record_with(jpeg_ls_of(flir_scene(0)) + next))),
              HasSubstr("contains another record"));
}

TEST(FlirFiles, WithPixelsOfSeveralKindsAreReadFrameByFrame) {
  const TemporaryFolder folder;
  FlirFileCamera camera;
  camera.raw_median = 18200;
  const cv::Mat1w scene = flir_scene(0);
  const std::string content = record_with(png_of(exchanged(scene.clone())).value(), 1000, camera) +
                              record_with(raw_pixels(scene), 1033, camera) +
                              record_with(jpeg_ls_of(scene), 1066, camera) +
                              record_with(png_of(scene).value(), 1100, camera);

  const auto recording = open_recording(folder.write("a.seq", content), "");

  ASSERT_TRUE(recording) << recording.error().message;
  ASSERT_EQ(recording->frame_count, 4u);
  for (std::uint64_t k = 0; k < 4; ++k) expect_counts(*recording, k, scene);
  EXPECT_EQ(recording->info.settings.at("RawThermalImageType"),
            "JPEG-LS; PNG with exchanged bytes; raw, little-endian");
}

TEST(FlirFiles, OfJpegPicturesAreJoinedFromTheirSegmentsInAnyOrder) {
  const TemporaryFolder folder;
  auto segments = flir_segments(record_with(raw_pixels(flir_scene(0))), 700);
  ASSERT_EQ(segments.size(), 6u);
  std::swap(segments[1], segments[4]);

  const auto recording = open_recording(folder.write("a.jpg", jpeg_with(segments)), "");

  ASSERT_TRUE(recording) << recording.error().message;
  ASSERT_EQ(recording->frame_count, 1u);
  expect_counts(*recording, 0, flir_scene(0));
  segments.erase(segments.begin() + 2);
  EXPECT_THAT(refused(folder.write("b.jpg", jpeg_with(segments))), HasSubstr("lacks segment"));
  EXPECT_THAT(refused(folder.write("c.jpg", jpeg_with({}))), HasSubstr("without the raw data of a FLIR camera"));
}

TEST(FlirFiles, WithPngPixelsAreReadInTheOrderThatTheMedianOrTheSmoothnessShows) {
  const TemporaryFolder folder;
  const cv::Mat1w scene = flir_scene(0);
  for (const bool swapped : {false, true}) {
    for (const int median : {0, 18200}) {
      FlirFileCamera camera;
      camera.raw_median = static_cast<std::uint16_t>(median);
      const std::string png = png_of(swapped ? exchanged(scene.clone()) : scene).value();

      const auto recording =
          open_recording(folder.write("a.jpg", jpeg_with(flir_segments(record_with(png, 1, camera), 60000))), "");

      ASSERT_TRUE(recording) << recording.error().message;
      expect_counts(*recording, 0, scene);
      EXPECT_EQ(recording->info.settings.at("RawThermalImageType"), swapped ? "PNG with exchanged bytes" : "PNG");
    }
  }
}

TEST(FlirFiles, OfARecordWithoutConstantsHaveThoseOfTheRecordBefore) {
  const TemporaryFolder folder;
  const auto bare = [](int k) {
    return flir_record("", flir_raw_data(flir_width, flir_height, raw_pixels(flir_scene(k))));
  };

  const auto recording = open_recording(folder.write("a", record_with(raw_pixels(flir_scene(0))) + bare(1)), "");

  ASSERT_TRUE(recording) << recording.error().message;
  ASSERT_EQ(recording->frame_count, 2u);
  expect_counts(*recording, 1, flir_scene(1));
  EXPECT_THAT(refused(folder.write("b", bare(0))), HasSubstr("does not contain the constants"));
}

TEST(FlirFiles, MayHaveZerosBetweenTheirRecordsAndNothingElse) {
  const TemporaryFolder folder;
  const std::string record = record_with(raw_pixels(flir_scene(0)));
  const std::string zeros(100'000, '\0');

  const auto recording = open_recording(folder.write("a.seq", record + zeros + record + zeros), "");

  ASSERT_TRUE(recording) << recording.error().message;
  EXPECT_EQ(recording->frame_count, 2u);
  EXPECT_THAT(refused(folder.write("b.seq", record + zeros + "x" + record)), HasSubstr("no FFF record at byte"));
}

// As the file of a T1030sc: the length counts padding that the last record of the file does not have.
TEST(FlirFiles, WhoseLastRecordLacksItsPaddingAreReadToTheEnd) {
  const TemporaryFolder folder;
  const std::string padding(4, '\0'), padded = record_with(jpeg_ls_of(flir_scene(0)) + padding);
  const auto cut = [&](std::size_t missing) {
    return folder.write("a.csq", padded + padded.substr(0, padded.size() - missing));
  };

  const auto recording = open_recording(cut(4), "");

  ASSERT_TRUE(recording) << recording.error().message;
  ASSERT_EQ(recording->frame_count, 2u);
  expect_counts(*recording, 1, flir_scene(0));
  EXPECT_THAT(refused(cut(5)), HasSubstr("the file is truncated"));
  EXPECT_THAT(refused(cut(40)), HasSubstr("the file is truncated"));
}

// Encoded by FFmpeg's JPEG-LS encoder, which shares no code with CharLS.
TEST(CompressedPictures, InJpegLsOfAnotherEncoderAreDecoded) {
  const std::string bytes(
      "\xff\xd8\xff\xf7\x00\x0b\x10\x00\x06\x00\x0a\x01\x01\x11\x00\xff\xda\x00\x08\x01\x01\x00\x00\x00\x00\x00\x00"
      "\x32\x7c\x49\x88\xf2\x2c\x87\x41\x9f\xcf\x67\x73\x9b\x4d\x31\xa0\x15\x85\x01\x20\x1e\x04\x02\x81\xcc\x6b\x4d"
      "\x20\x24\x04\x7e\x88\x31\xfa\x7c\x90\x52\x2c\x80\xb4\xdf\x49\x84\x39\x8f\x92\xe9\x64\x37\x8f\x50\xe2\xd2\x4b"
      "\x48\xda\xa2\x6d\x51\x36\xa6\x9d\x83\xfa\x28\xdf\x1f\x23\x6c\x7a\x9a\xe4\x99\xa6\x3d\xc7\xb0\xff\xd9",
      106);

  const auto counts = decode_jpeg_ls(bytes, {10, 6});

  ASSERT_TRUE(counts) << counts.error().message;
  for (int y = 0; y < 6; ++y) {
    for (int x = 0; x < 10; ++x) EXPECT_EQ((*counts)(y, x), 9000 + 37 * x + 211 * y + x * y * 7919 % 97);
  }
}

TEST(CompressedPictures, OfAnotherSizeOrCodingOrCutOffAnywhereAreRefusedWithASentence) {
  const cv::Size size(flir_width, flir_height);
  const cv::Mat1w scene = flir_scene(0);
  const std::string good = jpeg_ls_of(scene), png = png_of(scene).value();

  EXPECT_THAT(decode_jpeg_ls(good, {40, 31}).error().message, HasSubstr("is 40 x 30, but its record states 40 x 31"));
  EXPECT_THAT(decode_jpeg_ls(png, size).error().message, HasSubstr("cannot be decoded"));
  EXPECT_THAT(decode_png(png, {41, 30}).error().message, HasSubstr("is 40 x 30 of 16 bits"));
  EXPECT_THAT(decode_png(png_of(cv::Mat1b(30, 40, uchar{7})).value(), size).error().message, HasSubstr("8 bits"));
  EXPECT_THAT(decode_jpeg_ls(good, {65535, 65535}).error().message, HasSubstr("too large"));
  EXPECT_THAT(decode_png(png, {65535, 65535}).error().message, HasSubstr("too large"));
  for (std::size_t length = 0; length + 2 < good.size(); length += 7)
    EXPECT_FALSE(decode_jpeg_ls(good.substr(0, length), size)) << length;
  for (std::size_t length = 0; length < png.size() - 16; length += 7)
    EXPECT_FALSE(decode_png(png.substr(0, length), size)) << length;
}

TEST(FlirFiles, ThatLieAboutTheirSizeEndWithASentence) {
  const TemporaryFolder folder;
  const std::string pixels = jpeg_ls_of(flir_scene(0)), good = record_with(pixels);
  const auto changed = [&](std::size_t at, std::uint64_t value, std::size_t length) {
    std::string bytes = good;
    put(bytes, at, value, length);
    return folder.write("hostile.csq", bytes);
  };
  constexpr std::size_t entry_count = 28, raw_offset = 64 + 32 + 12, raw_length = raw_offset + 4;
  const std::size_t raw = 128 + 0x470;

  EXPECT_THAT(refused(changed(entry_count, 1'000'000'000, 4)), HasSubstr("truncated in its index"));
  EXPECT_THAT(refused(changed(raw_offset, 200, 4)), HasSubstr("blocks that overlap"));
  EXPECT_THAT(refused(changed(raw_offset, 0, 4)), HasSubstr("blocks that overlap"));
  EXPECT_THAT(refused(changed(raw_length, 0xFFFFFFFF, 4)), HasSubstr("points outside the file"));
  EXPECT_THAT(refused(changed(raw + 2, 0xFFFFFFFF, 4)), HasSubstr("too large"));
  EXPECT_THAT(refused(changed(raw + 2, 41, 2)), HasSubstr("its record states 41 x 30"));
  EXPECT_THAT(refused(changed(raw + 32 + 1, 0, 1)), HasSubstr("unknown compression or are truncated"));
  EXPECT_THAT(refused(folder.write("cut.csq", record_with(pixels.substr(0, pixels.size() / 2)))),
              HasSubstr("JPEG-LS picture cannot be decoded"));
}

TEST(FilesByContent, AreReadWhateverTheirSuffix) {
  const TemporaryFolder folder;
  const std::string flir = record_with(raw_pixels(flir_scene(0)));
  for (const char* name : {"a.seq", "a.csq", "a.fff", "a.raw", "a.tif", "a"}) {
    const auto recording = open_recording(folder.write(name, flir), "");
    ASSERT_TRUE(recording) << recording.error().message;
    EXPECT_EQ(recording->info.vendor, "FLIR");
  }
}

TEST(FilesByContent, ThatAreNoRecordingAreRefusedByTheirContent) {
  const TemporaryFolder folder;
  const std::string png = png_of(flir_scene(0)).value();

  EXPECT_THAT(refused(folder.write("a.seq", png)), HasSubstr("the file is a PNG picture"));
  EXPECT_THAT(refused(folder.write("b.tif", std::string("\0\0\0\x18"
                                                        "ftypmp42",
                                                        12))),
              HasSubstr("an MP4 or QuickTime video"));
  EXPECT_THAT(refused(folder.write("c.csq", "hello world")),
              HasSubstr("begins with the bytes 68 65 6c 6c 6f 20 77 6f"));
  EXPECT_THAT(refused(folder.write("d.raw", "")), HasSubstr("the file is empty"));
  const auto stated = open_recording(folder.write("e.seq", raw_pixels(flir_scene(0))), "width=40&height=30");
  ASSERT_TRUE(stated) << stated.error().message;
  expect_counts(*stated, 0, flir_scene(0));
}

}  // namespace
}  // namespace todbench
