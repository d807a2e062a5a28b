// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include "acquisition/recording/flir_record.h"
#include "acquisition/recording/flir_seq.h"
#include "acquisition/recording/raw_recording.h"
#include "acquisition/recording/recording_backend.h"
#include "tests/support/source_file.h"

namespace todbench {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

const std::filesystem::path golden = source_file("tests/golden/real");

/// A file that goes with the test.
class ScratchFile {
 public:
  explicit ScratchFile(const std::string& suffix, const std::vector<char>& content)
      : path_(std::filesystem::path(testing::TempDir()) /
              (std::string(testing::UnitTest::GetInstance()->current_test_info()->name()) + suffix)) {
    std::ofstream(path_, std::ios::binary).write(content.data(), static_cast<std::streamsize>(content.size()));
  }
  ~ScratchFile() { std::filesystem::remove(path_); }
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

std::vector<char> content_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

TEST(RawRecording, ReadsLittleEndianCountsRowByRow) {
  const ScratchFile file(".raw", {1, 0, 2, 0, 3, 0, 0, 1, 5, 0, 6, 0, 7, 0, 8, 0, 9, 0, 10, 0, 11, 0, 12, 0});

  const auto recording = open_raw_recording(file.path(), {.width = 3, .height = 2});

  ASSERT_TRUE(recording) << recording.error().message;
  EXPECT_EQ(recording->frame_count, 2U);
  const auto frame = recording->read(0);
  ASSERT_TRUE(frame) << frame.error().message;
  EXPECT_EQ(cv::countNonZero(frame->counts != (cv::Mat1w(2, 3) << 1, 2, 3, 256, 5, 6)), 0);
}

TEST(RawRecording, RefusesAFileThatIsShort) {
  const ScratchFile file(".raw", std::vector<char>(23));

  const auto recording = open_raw_recording(file.path(), {.width = 3, .height = 2});

  ASSERT_FALSE(recording);
  EXPECT_EQ(recording.error().code, ErrorCode::invalid_input);
  EXPECT_THAT(recording.error().message, HasSubstr("23 bytes"));
}

TEST(RawRecording, RefusesAnEmptyFileAndAnImpossibleGeometry) {
  const ScratchFile empty(".raw", {});

  EXPECT_EQ(open_raw_recording(empty.path(), {.width = 3, .height = 2}).error().code, ErrorCode::invalid_input);
  EXPECT_EQ(open_raw_recording(empty.path(), {.width = 0, .height = 2}).error().code, ErrorCode::invalid_input);
  EXPECT_EQ(open_raw_recording("/no/such/file.raw", {.width = 3, .height = 2}).error().code, ErrorCode::io);
}

TEST(RawRecording, AFileThatShrinksWhileItIsReadEndsTheSource) {
  const ScratchFile file(".raw", std::vector<char>(24));
  auto recording = open_raw_recording(file.path(), {.width = 3, .height = 2});
  ASSERT_TRUE(recording);
  const auto source = recorded_source(std::move(*recording));
  ASSERT_TRUE(source->start() && source->next(1s));
  std::filesystem::resize_file(file.path(), 20);

  const auto frame = source->next(1s);

  ASSERT_FALSE(frame);
  EXPECT_EQ(frame.error().code, ErrorCode::integrity);
}

TEST(RecordingBackend, OpensARawFileWithItsGeometryAndScaleInTheId) {
  const std::string id = "file:" + (golden / "lepton_b_160x120_u16le.raw").string() +
                         "?width=160&height=120&bits=14&frame_rate_hz=8.7&kelvin_per_count=0.02&offset_k=200";

  const auto source = recording_backend()->open(id);

  ASSERT_TRUE(source) << source.error().message;
  const SourceInfo& info = (*source)->info();
  EXPECT_EQ(info.id, id);
  EXPECT_EQ(info.width, 160);
  EXPECT_EQ(info.height, 120);
  EXPECT_EQ(info.significant_bits, 14);
  EXPECT_EQ(info.frame_rate_hz, 8.7);
  EXPECT_DOUBLE_EQ(info.scale.kelvin(5000).value(), 300);
}

TEST(RecordingBackend, NamesWhatIsWrongWithAnId) {
  const std::string file = "file:" + (golden / "lepton_b_160x120_u16le.raw").string();
  const auto backend = recording_backend();
  const std::vector<std::pair<std::string, std::string>> wrong{
      {file, "width and height"},
      {file + "?width=160&height=119", "whole number"},
      {file + "?width=160&height=120&colour=1", "unknown key colour"},
      {file + "?width=wide&height=120", "'width=wide' is not KEY=NUMBER"},
      {file + "?width=160&width=160&height=120", "stated twice"}};

  for (const auto& [id, reason] : wrong) {
    const auto source = backend->open(id);
    ASSERT_FALSE(source) << id;
    EXPECT_EQ(source.error().code, ErrorCode::invalid_input) << id;
    EXPECT_THAT(source.error().message, HasSubstr(reason));
  }
  EXPECT_EQ(backend->open("file:/no/such/file.raw?width=1&height=1").error().code, ErrorCode::not_found);
}

/// Temporal noise per sample in counts, each from the differences of successive frames divided by the square root of
/// two.
struct TemporalNoise {
  double from_deviation = 0;  ///< standard deviation over time of every pixel, then the median over pixels
  double from_quantiles = 0;  ///< range of the middle 90 % of all differences, divided by that of a standard normal
};

TemporalNoise temporal_noise(const Recording& recording) {
  const auto pixels = static_cast<std::size_t>(recording.info.width * recording.info.height);
  std::vector<double> sum(pixels);
  std::vector<double> sum_of_squares(pixels);
  std::vector<double> histogram(2 * 65536);
  cv::Mat1w previous = recording.read(0).value().counts;
  for (std::uint64_t k = 1; k < recording.frame_count; ++k) {
    const cv::Mat1w counts = recording.read(k).value().counts;
    for (std::size_t i = 0; i < pixels; ++i) {
      const int difference = counts.ptr<ushort>()[i] - previous.ptr<ushort>()[i];
      sum[i] += difference;
      sum_of_squares[i] += static_cast<double>(difference) * difference;
      ++histogram[static_cast<std::size_t>(difference + 65536)];
    }
    previous = counts;
  }
  const auto differences = static_cast<double>(recording.frame_count - 1);
  std::vector<double> deviations(pixels);
  for (std::size_t i = 0; i < pixels; ++i) {
    const double mean = sum[i] / differences;
    deviations[i] = std::sqrt(sum_of_squares[i] / differences - mean * mean);
  }
  std::nth_element(deviations.begin(), deviations.begin() + static_cast<std::ptrdiff_t>(pixels / 2), deviations.end());
  // Differences are whole counts; each one stands for the interval of one count round it.
  const auto quantile = [&](double share) {
    double left = share * differences * static_cast<double>(pixels);
    std::size_t bin = 0;
    while (left > histogram[bin]) left -= histogram[bin++];
    return static_cast<double>(bin) - 65536.5 + left / histogram[bin];
  };
  constexpr double normal_range = 2 * 1.6448536;
  return {deviations[pixels / 2] / std::sqrt(2.0), (quantile(0.95) - quantile(0.05)) / normal_range / std::sqrt(2.0)};
}

class LeptonRecording : public testing::TestWithParam<std::pair<const char*, std::uint64_t>> {};

TEST_P(LeptonRecording, HasATemporalNoiseOfPoint8CountsByTwoIndependentEstimates) {
  const auto& [name, frames] = GetParam();
  const auto recording = open_raw_recording(golden / name, {.width = 160, .height = 120});
  ASSERT_TRUE(recording) << recording.error().message;
  ASSERT_EQ(recording->frame_count, frames);

  const TemporalNoise noise = temporal_noise(*recording);

  RecordProperty("from_deviation", std::to_string(noise.from_deviation));
  RecordProperty("from_quantiles", std::to_string(noise.from_quantiles));
  // Published with the recordings: about 0.8 counts.
  EXPECT_NEAR(noise.from_deviation, 0.8, 0.05);
  // The differences are not Gaussian (two thirds are 0, edges that move give tails), so the two agree to a tenth, not
  // to the statistical error of a thousandth.
  EXPECT_NEAR(noise.from_quantiles / noise.from_deviation, 1, 0.12);
}

INSTANTIATE_TEST_SUITE_P(Both, LeptonRecording,
                         testing::Values(std::pair{"lepton_a_160x120_u16le.raw", 100U},
                                         std::pair{"lepton_b_160x120_u16le.raw", 102U}),
                         [](const auto& test_case) { return std::string(test_case.param.first).substr(0, 8); });

TEST(FlirSeq, FindsBothFramesWithTheirGeometryAndConstants) {
  const auto recording = open_flir_seq(golden / "flir_sc660.seq");

  ASSERT_TRUE(recording) << recording.error().message;
  ASSERT_EQ(recording->frame_count, 2U);
  const SourceInfo& info = recording->info;
  EXPECT_EQ(info.width, 640);
  EXPECT_EQ(info.height, 480);
  EXPECT_EQ(info.model, "FLIR SC660");
  EXPECT_EQ(info.serial, "404003980");
  const auto setting = [&](const char* name) { return std::stod(info.settings.at(name)); };
  EXPECT_EQ(info.settings.at("RawThermalImageType"), "raw, little-endian");
  EXPECT_NEAR(setting("PlanckR1"), 21106.77, 0.01);
  EXPECT_NEAR(setting("PlanckR2"), 0.012545258, 1e-9);
  EXPECT_EQ(setting("PlanckB"), 1501);
  EXPECT_EQ(setting("PlanckF"), 1);
  EXPECT_EQ(setting("PlanckO"), -7340);
  EXPECT_NEAR(setting("ObjectEmissivity"), 0.95, 1e-6);
  EXPECT_NEAR(setting("ReflectedTemperature"), 293.15, 1e-4);
  EXPECT_GT(recording->read(1).value().device_time_ns, recording->read(0).value().device_time_ns);
}

TEST(FlirSeq, MapsThePublishedConstantsToThePlanckScaleWithTheSameTemperatures) {
  const FlirPlanck flir{21106.77, 0.012545258, 1501, 1, -7340};

  const auto scale = planck_scale(flir);

  ASSERT_TRUE(scale) << scale.error().message;
  for (const double counts : {9000.0, 17220.0, 18816.0, 20817.0, 60000.0}) {
    const double published = flir.b / std::log(flir.r1 / (flir.r2 * (counts + flir.o)) + flir.f);
    // Two orders of the same five roundings: relative 1e-14 of some hundred kelvin.
    EXPECT_NEAR(scale->kelvin(counts).value(), published, 1e-11);
    EXPECT_NEAR(scale->counts(published).value(), counts, 1e-8);
  }
}

TEST(FlirSeq, ServesItsFramesAtPlausibleTemperatures) {
  const auto source = recording_backend()->open("file:" + (golden / "flir_sc660.seq").string());
  ASSERT_TRUE(source) << source.error().message;
  ASSERT_TRUE((*source)->start());

  for (int k = 0; k < 2; ++k) {
    const auto frame = (*source)->next(1s);
    ASSERT_TRUE(frame) << frame.error().message;
    const auto kelvin = to_kelvin(*frame);
    ASSERT_TRUE(kelvin) << kelvin.error().message;
    double low = 0;
    double high = 0;
    cv::minMaxLoc(*kelvin, &low, &high);
    // An indoor scene with a warm animal: between a cool wall and body temperature. The camera's range is 233 ... 393
    // K.
    EXPECT_GT(low, 283);
    EXPECT_LT(low, 296);
    EXPECT_GT(high, 300);
    EXPECT_LT(high, 315);
  }
  EXPECT_EQ((*source)->next(1s).error().code, ErrorCode::disconnected);
}

TEST(FlirSeq, RefusesAGeometryStatedBesideTheOneInTheFile) {
  const auto source = recording_backend()->open("file:" + (golden / "flir_sc660.seq").string() + "?widht=640");

  ASSERT_FALSE(source);
  EXPECT_EQ(source.error().code, ErrorCode::invalid_input);
  EXPECT_NE(source.error().message.find("remove '?widht=640'"), std::string::npos) << source.error().message;
}

TEST(FlirSeq, RefusesAFileCutOffAnywhereInsideARecord) {
  const auto whole = content_of(golden / "flir_sc660.seq");
  for (const std::size_t size : {std::size_t{3}, std::size_t{63}, std::size_t{100}, std::size_t{400},
                                 std::size_t{617'179}, std::size_t{617'200}, whole.size() - 1}) {
    const ScratchFile file(".seq", {whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)});

    const auto recording = open_flir_seq(file.path());

    ASSERT_FALSE(recording) << size;
    EXPECT_EQ(recording.error().code, ErrorCode::invalid_input) << size;
  }
}

TEST(FlirSeq, RefusesRandomlyDamagedHeadersWithoutReadingOutsideTheFile) {
  const auto whole = content_of(golden / "flir_sc660.seq");
  std::vector<char> first(whole.begin(), whole.begin() + 617'180);
  // Every byte of header and index, set to its extreme values. Some changes are harmless; none may read outside
  // (sanitizers watch).
  int refused = 0;
  for (std::size_t byte = 0; byte < 128; ++byte) {
    for (const char value : {'\x00', '\x7f', '\xff'}) {
      auto damaged = first;
      damaged[byte] = value;
      const ScratchFile file(".seq", damaged);
      if (!open_flir_seq(file.path())) ++refused;
    }
  }

  EXPECT_GT(refused, 60);
}

}  // namespace
}  // namespace todbench
