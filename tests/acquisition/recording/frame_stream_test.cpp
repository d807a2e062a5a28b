// SPDX-License-Identifier: GPL-3.0-or-later
// Recordings of the bench: what comes back, and what is left after a crash.
#include "acquisition/recording/frame_stream.h"

#include <gmock/gmock.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <functional>
#include <limits>

#include "acquisition/base/rng.h"
#include "acquisition/recording/recording_backend.h"
#include "acquisition/recording/recording_camera.h"
#include "acquisition/recording/tiff_stack.h"
#include "acquisition/recording/tiff_writer.h"

namespace todbench {
namespace {

using testing::HasSubstr;

class Recordings : public testing::Test {
 protected:
  Recordings() : folder_(std::filesystem::temp_directory_path() / ("recordings-" + std::to_string(::getpid()))) {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  ~Recordings() override { std::filesystem::remove_all(folder_); }
  [[nodiscard]] std::filesystem::path file(const std::string& name) const { return folder_ / name; }

 private:
  std::filesystem::path folder_;
};

StreamHeader header() {
  StreamHeader h;
  h.info.id = "gige:FLIR-1";
  h.info.vendor = "FLIR";
  h.info.model = "AX5";
  h.info.serial = "48000123";
  h.info.firmware = "1.0\xff";  // text of a device need not be UTF-8
  h.info.transport = "GigE Vision";
  h.info.width = 16;
  h.info.height = 12;
  h.info.pixel_format = "Mono14";
  h.info.significant_bits = 14;
  h.info.frame_rate_hz = 59.94005994005994;
  h.info.scale = *RadiometricScale::planck({.r = 366545.1, .b = 1428.1, .f = 1.0, .o = -71.25});
  h.info.settings = {{"NUCMode", "Manual"}};
  h.info.warnings = {"the socket buffer is small"};
  h.created_utc = "2026-01-31T12:34:56Z";
  h.created_host_ns = 123456789012345;
  h.annotations = {{"target", "black body 7"}};
  return h;
}

Frame frame(std::uint64_t k) {
  Frame f;
  f.counts.create(12, 16);
  const RandomStream random = RandomStream(1, "frame").sub(k);
  std::uint64_t i = 0;
  for (auto& pixel : f.counts) pixel = static_cast<std::uint16_t>(random.below(16384, i++));
  f.sequence = 100 + k;
  f.device_time_ns = static_cast<std::int64_t>(k) * 16'683'350;
  f.host_time_ns = 5'000'000'000 + static_cast<std::int64_t>(k) * 16'700'000;
  f.significant_bits = 14;
  f.scale = std::make_shared<RadiometricScale>();
  return f;
}

bool equal(const cv::Mat1w& a, const cv::Mat1w& b) {
  return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin());
}

FrameStreamWriter written(const std::filesystem::path& path, std::uint64_t frames) {
  auto writer = FrameStreamWriter::create(path, header());
  EXPECT_TRUE(writer.has_value()) << writer.error().message;
  for (std::uint64_t k = 0; k < frames; ++k) EXPECT_TRUE(writer->append(frame(k)).has_value());
  return *std::move(writer);
}

std::string content(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void overwrite(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary | std::ios::trunc)
      .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

TEST_F(Recordings, GiveBackTheCameraAndEveryFieldOfEveryFrame) {
  {
    auto writer = written(file("a"), 3);
    Frame special = frame(5);
    special.status = FrameStatus::incomplete;
    special.correction = CorrectionState::running;
    special.since_correction_s = 0.1;
    ASSERT_TRUE(writer.append(special).has_value());
    Frame empty = frame(6);
    empty.counts = cv::Mat1w();
    empty.status = FrameStatus::wrong_size;
    ASSERT_TRUE(writer.append(empty).has_value());
  }

  const auto stream = open_frame_stream(file("a"));

  ASSERT_TRUE(stream.has_value()) << stream.error().message;
  const StreamHeader expected = header();
  EXPECT_EQ(stream->header.info.serial, expected.info.serial);
  EXPECT_EQ(stream->header.info.scale, expected.info.scale);
  EXPECT_EQ(stream->header.info.frame_rate_hz, expected.info.frame_rate_hz);
  EXPECT_EQ(stream->header.info.settings, expected.info.settings);
  EXPECT_EQ(stream->header.annotations, expected.annotations);
  EXPECT_EQ(stream->header.created_host_ns, expected.created_host_ns);
  ASSERT_EQ(stream->recording.frame_count, 5u);
  for (std::uint64_t k = 0; k < 3; ++k) {
    const auto read = stream->recording.read(k);
    ASSERT_TRUE(read.has_value());
    EXPECT_TRUE(equal(read->counts, frame(k).counts));
    EXPECT_EQ(read->sequence, frame(k).sequence);
    EXPECT_EQ(read->device_time_ns, frame(k).device_time_ns);
    EXPECT_EQ(read->host_time_ns, frame(k).host_time_ns);
    EXPECT_EQ(read->status, FrameStatus::complete);
    EXPECT_EQ(read->correction, CorrectionState::unknown);
  }
  EXPECT_EQ(stream->recording.read(3)->status, FrameStatus::incomplete);
  EXPECT_EQ(stream->recording.read(3)->correction, CorrectionState::running);
  EXPECT_EQ(stream->recording.read(3)->since_correction_s, 0.1);
  EXPECT_EQ(stream->recording.read(4)->status, FrameStatus::wrong_size);
  EXPECT_EQ(stream->torn_bytes, 0u);
}

TEST_F(Recordings, KeepEveryKindOfScaleExactly) {
  for (const RadiometricScale& scale :
       {RadiometricScale(), *RadiometricScale::linear({.kelvin_per_count = 1.0 / 3, .offset_k = 273.15}),
        *RadiometricScale::table({.counts = {1, 2.5, 7}, .temperature_k = {290.1, 291.0 / 3, 300}})
             .or_else([](const Error&) -> Result<RadiometricScale> { return RadiometricScale(); })}) {
    StreamHeader h = header();
    h.info.scale = scale;
    ASSERT_TRUE(FrameStreamWriter::create(file("scale"), h).has_value());

    const auto stream = open_frame_stream(file("scale"));

    ASSERT_TRUE(stream.has_value()) << stream.error().message;
    EXPECT_EQ(stream->header.info.scale, scale);
  }
}

TEST_F(Recordings, AreReadableUpToTheLastWholeFrameWhereverTheyWereCutOff) {
  const std::uint64_t bytes_of_two = written(file("two"), 2).bytes();
  const std::uint64_t bytes_of_three = written(file("three"), 3).bytes();
  const std::string whole = content(file("three"));
  ASSERT_EQ(whole.size(), bytes_of_three);

  for (std::uint64_t length = bytes_of_two; length < bytes_of_three; ++length) {
    overwrite(file("cut"), whole.substr(0, length));
    const auto stream = open_frame_stream(file("cut"));

    ASSERT_TRUE(stream.has_value()) << length;
    EXPECT_EQ(stream->recording.frame_count, 2u) << length;
    EXPECT_EQ(stream->torn_bytes, length - bytes_of_two);
    EXPECT_TRUE(equal(stream->recording.read(1)->counts, frame(1).counts));
  }
}

TEST_F(Recordings, AreReadableAfterTheWriterWasKilled) {
  int ready[2];
  ASSERT_EQ(::pipe(ready), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    auto writer = FrameStreamWriter::create(file("killed"), header());
    for (std::uint64_t k = 0;; ++k) {
      if (!writer || !writer->append(frame(k))) ::_exit(1);
      if (k == 20 && ::write(ready[1], "x", 1) != 1) ::_exit(1);
    }
  }
  char byte = 0;
  ASSERT_EQ(::read(ready[0], &byte, 1), 1);
  ::kill(child, SIGKILL);
  int status = 0;
  ::waitpid(child, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status));

  const auto stream = open_frame_stream(file("killed"));

  ASSERT_TRUE(stream.has_value()) << stream.error().message;
  ASSERT_GE(stream->recording.frame_count, 21u);
  for (std::uint64_t k = 0; k < stream->recording.frame_count; ++k) {
    ASSERT_TRUE(equal(stream->recording.read(k)->counts, frame(k).counts)) << k;
    ASSERT_EQ(stream->recording.read(k)->status, FrameStatus::complete) << k;
  }
}

TEST_F(Recordings, InTiffAreReadableAtEveryLengthThatACrashCanLeave) {
  std::vector<std::uint64_t> lengths;
  {
    auto tiff = TiffWriter::create(file("whole.tif"));
    for (std::uint64_t k = 0; k < 3; ++k) {
      ASSERT_TRUE(tiff->append(frame(k).counts).has_value());
      lengths.push_back(std::filesystem::file_size(file("whole.tif")));
    }
  }
  const std::string whole = content(file("whole.tif"));
  // A page is written behind the others, and then the offset of its directory into the one in front of it: what a crash
  // leaves is a file of two pages with any part of the third behind them.
  const std::string link(8, '\0');
  const std::uint64_t last_link = lengths[1] - 8;

  for (std::uint64_t length = lengths[1]; length <= lengths[2]; ++length) {
    overwrite(file("cut.tif"), whole.substr(0, length).replace(last_link, 8, link));
    const auto stack = open_tiff_stack(file("cut.tif"), {});

    ASSERT_TRUE(stack.has_value()) << stack.error().message;
    ASSERT_EQ(stack->frame_count, 2u) << length;
    for (const std::uint64_t k : {0u, 1u}) ASSERT_TRUE(equal(stack->read(k)->counts, frame(k).counts)) << length;
  }
}

TEST_F(Recordings, InTiffAreReadableAfterTheWriterWasKilled) {
  int ready[2];
  ASSERT_EQ(::pipe(ready), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    auto tiff = TiffWriter::create(file("killed.tif"));
    for (std::uint64_t k = 0;; ++k) {
      if (!tiff || !tiff->append(frame(k).counts)) ::_exit(1);
      if (k == 20 && ::write(ready[1], "x", 1) != 1) ::_exit(1);
    }
  }
  char byte = 0;
  ASSERT_EQ(::read(ready[0], &byte, 1), 1);
  ::kill(child, SIGKILL);
  int status = 0;
  ::waitpid(child, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status));

  const auto stack = open_tiff_stack(file("killed.tif"), {});

  ASSERT_TRUE(stack.has_value()) << stack.error().message;
  ASSERT_GE(stack->frame_count, 21u);
  for (std::uint64_t k = 0; k < stack->frame_count; ++k)
    ASSERT_TRUE(equal(stack->read(k)->counts, frame(k).counts)) << k;
}

TEST_F(Recordings, WhoseFileIsNotThereAnyMoreSaySo) {
  const auto deleted = [](const std::filesystem::path& path) { std::filesystem::remove(path); };
  const auto moved = [](const std::filesystem::path& path) { std::filesystem::rename(path, path.string() + ".old"); };
  const auto replaced = [](const std::filesystem::path& path) {
    overwrite(path.string() + ".new", content(path));
    std::filesystem::rename(path.string() + ".new", path);
  };
  const auto cut = [](const std::filesystem::path& path) { std::filesystem::resize_file(path, 100); };
  const std::function<void(const std::filesystem::path&)> accidents[] = {deleted, moved, replaced, cut};
  for (const auto& accident : accidents) {
    auto stream = written(file("a"), 3);
    auto tiff = TiffWriter::create(file("a.tif"));
    ASSERT_TRUE(tiff->append(frame(0).counts).has_value());
    ASSERT_TRUE(stream.verified_frames().has_value());
    ASSERT_TRUE(tiff->verified_pages().has_value());
    accident(file("a"));
    accident(file("a.tif"));

    EXPECT_EQ(stream.sync().error().code, ErrorCode::io);
    EXPECT_EQ(stream.verified_frames().error().code, ErrorCode::io);
    EXPECT_EQ(tiff->verified_pages().error().code, ErrorCode::io);
  }
}

TEST_F(Recordings, WhoseFileWasDeletedTakeNothingMore) {
  auto stream = written(file("a"), 3);
  auto tiff = TiffWriter::create(file("a.tif"));
  std::filesystem::remove(file("a"));
  std::filesystem::remove(file("a.tif"));

  EXPECT_EQ(stream.append(frame(3)).error().code, ErrorCode::io);
  EXPECT_EQ(tiff->append(frame(0).counts).error().code, ErrorCode::io);
  EXPECT_EQ(stream.frames(), 3u);
  EXPECT_EQ(tiff->pages(), 0u);
}

TEST_F(Recordings, OfACameraWithAnImpossibleFrameRateAreReadWithoutOne) {
  for (const double rate : {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(),
                            std::numeric_limits<double>::quiet_NaN(), -5.0}) {
    StreamHeader h = header();
    h.info.frame_rate_hz = rate;
    ASSERT_TRUE(FrameStreamWriter::create(file("rate"), h).has_value());

    const auto stream = open_frame_stream(file("rate"));

    ASSERT_TRUE(stream.has_value()) << stream.error().message;
    EXPECT_EQ(stream->header.info.frame_rate_hz, 0);
  }
  for (const char* rate : {"inf", "nan", "-5", "-inf", "-0.001"}) {
    overwrite(file("raw"), std::string(2 * 4 * 4, 'x'));
    EXPECT_EQ(open_recording(file("raw"), std::string("width=4&height=4&frame_rate_hz=") + rate).error().code,
              ErrorCode::invalid_input)
        << rate;
  }
}

TEST_F(Recordings, KeepHowTheNumberOfAFrameCameAbout) {
  auto writer = FrameStreamWriter::create(file("a"), header());
  for (const auto numbering : {Numbering::counted, Numbering::restarted, Numbering::timed, Numbering::unread}) {
    Frame f = frame(0);
    f.numbering = numbering;
    ASSERT_TRUE(writer->append(f).has_value());
  }
  const auto source = recorded_source(open_frame_stream(file("a"))->recording);
  ASSERT_TRUE(source->start());

  for (const auto numbering : {Numbering::counted, Numbering::restarted, Numbering::timed, Numbering::unread})
    EXPECT_EQ(source->next(std::chrono::milliseconds(1))->numbering, numbering);
}

TEST_F(Recordings, NoticeEveryFlippedByteOfAFrame) {
  const std::uint64_t before = written(file("one"), 1).bytes();
  (void)written(file("two"), 2);
  const std::string whole = content(file("two"));

  for (std::uint64_t at = before; at < whole.size(); ++at) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
    overwrite(file("damaged"), damaged);
    const auto stream = open_frame_stream(file("damaged"));

    ASSERT_TRUE(stream.has_value());
    // Damage in the head of the record ends the recording there; damage behind it makes the frame incomplete.
    const bool gone = stream->recording.frame_count == 1;
    ASSERT_TRUE(gone || stream->recording.read(1)->status == FrameStatus::incomplete) << at;
    EXPECT_TRUE(equal(stream->recording.read(0)->counts, frame(0).counts));
  }
}

TEST_F(Recordings, KeepFailuresAndReadingsInTheirPlaces) {
  {
    auto writer = written(file("a"), 2);
    ASSERT_TRUE(writer.append_reading({"clock", "77"}).has_value());
    ASSERT_TRUE(writer.append_failure({ErrorCode::timeout, "no frame"}, FailedCall::next).has_value());
    ASSERT_TRUE(writer.append(frame(2)).has_value());
    ASSERT_TRUE(writer.append_reading({"rest", "-5 and more"}).has_value());
    ASSERT_TRUE(writer.append_failure({ErrorCode::disconnected, "gone"}, FailedCall::next).has_value());
  }
  auto stream = open_frame_stream(file("a"));
  ASSERT_TRUE(stream.has_value());
  const auto source = recorded_source(stream->recording, Playback::replay);
  ASSERT_TRUE(source->start().has_value());

  std::vector<std::string> seen;
  for (int i = 0; i < 5; ++i) {
    const auto next = source->next(std::chrono::milliseconds(1));
    seen.push_back(next ? std::to_string(next->sequence) : next.error().message);
  }

  EXPECT_THAT(seen, testing::ElementsAre("100", "101", "no frame", "102", "gone"));
  EXPECT_THAT(stream->readings, testing::ElementsAre(Reading{"clock", "77"}, Reading{"rest", "-5 and more"}));
}

TEST_F(Recordings, RepeatAFailedCorrectionWhenACorrectionIsAskedFor) {
  {
    auto writer = written(file("a"), 1);
    ASSERT_TRUE(writer.append_failure({ErrorCode::disconnected, "gone"}, FailedCall::correct_nonuniformity));
    ASSERT_TRUE(writer.append(frame(1)));
  }
  auto stream = open_frame_stream(file("a"));
  ASSERT_TRUE(stream);
  const auto source = recorded_source(stream->recording, Playback::replay);
  ASSERT_TRUE(source->start());

  const auto before = source->correct_nonuniformity();
  ASSERT_TRUE(source->next(std::chrono::milliseconds(1)));
  const auto failed = source->correct_nonuniformity();
  const auto after = source->correct_nonuniformity();

  EXPECT_TRUE(before);
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error().code, ErrorCode::disconnected);
  EXPECT_TRUE(after);
  EXPECT_TRUE(source->next(std::chrono::milliseconds(1)));
}

TEST_F(Recordings, AreCamerasByTheirPath) {
  (void)written(file("a.todrec"), 4);
  const auto backend = recording_backend();

  const auto camera = backend->open("file:" + file("a.todrec").string());

  ASSERT_TRUE(camera.has_value()) << camera.error().message;
  EXPECT_EQ((*camera)->info().model, "AX5");
  EXPECT_TRUE((*camera)->info().scale.calibrated());
  ASSERT_TRUE((*camera)->start().has_value());
  EXPECT_TRUE(equal((*camera)->next(std::chrono::milliseconds(1))->counts, frame(0).counts));
}

TEST_F(Recordings, OfARecordingAreTheSameFrames) {
  (void)written(file("a"), 4);
  auto stream = open_frame_stream(file("a"));
  ASSERT_TRUE(stream.has_value());
  {
    auto copy = FrameStreamWriter::create(file("b"), stream->header);
    ASSERT_TRUE(copy.has_value());
    const auto shared = std::make_shared<FrameStreamWriter>(*std::move(copy));
    const auto camera = recording_camera(recorded_source(stream->recording, Playback::replay), shared);
    ASSERT_TRUE(camera->start().has_value());
    while (camera->next(std::chrono::milliseconds(1))) {
    }
  }

  const auto again = open_frame_stream(file("b"));

  ASSERT_TRUE(again.has_value());
  ASSERT_EQ(again->recording.frame_count, 4u);
  for (std::uint64_t k = 0; k < 4; ++k) {
    EXPECT_TRUE(equal(again->recording.read(k)->counts, frame(k).counts));
    EXPECT_EQ(again->recording.read(k)->host_time_ns, frame(k).host_time_ns);
    EXPECT_EQ(again->recording.read(k)->sequence, frame(k).sequence);
  }
  ASSERT_EQ(again->recording.failures.size(), 1u);
  EXPECT_EQ(again->recording.failures.front().error.code, ErrorCode::disconnected);
}

TEST_F(Recordings, RefuseWhatIsNotOne) {
  overwrite(file("empty"), "");
  overwrite(file("other"), "TODBREC2 and something else");
  overwrite(file("headless"), "TODBREC1");

  EXPECT_EQ(open_frame_stream(file("empty")).error().code, ErrorCode::invalid_input);
  EXPECT_EQ(open_frame_stream(file("other")).error().code, ErrorCode::invalid_input);
  EXPECT_THAT(open_frame_stream(file("headless")).error().message, HasSubstr("no header"));
  EXPECT_EQ(open_frame_stream(file("absent")).error().code, ErrorCode::io);
}

TEST_F(Recordings, FailWithIoWhenTheDiskRefuses) {
  auto writer = FrameStreamWriter::create("/dev/full", header());

  ASSERT_FALSE(writer.has_value());
  EXPECT_EQ(writer.error().code, ErrorCode::io);
}

TEST_F(Recordings, GoThroughTiffWithoutLosingABit) {
  auto tiff = TiffWriter::create(file("stack.tif"));
  ASSERT_TRUE(tiff.has_value()) << tiff.error().message;
  for (std::uint64_t k = 0; k < 5; ++k) ASSERT_TRUE(tiff->append(frame(k).counts).has_value());
  ASSERT_TRUE(tiff->verified_pages().has_value());

  const auto stack = open_recording(file("stack.tif"), "bits=14&kelvin_per_count=0.04");

  ASSERT_TRUE(stack.has_value()) << stack.error().message;
  ASSERT_EQ(stack->frame_count, 5u);
  EXPECT_EQ(stack->info.significant_bits, 14);
  EXPECT_TRUE(stack->info.scale.calibrated());
  for (const std::uint64_t k : {4u, 0u, 2u, 1u, 3u}) EXPECT_TRUE(equal(stack->read(k)->counts, frame(k).counts)) << k;
}

TEST_F(Recordings, AreReadFromAFolderOfSinglePagesInTheOrderOfTheirNames) {
  std::filesystem::create_directories(file("pages"));
  for (std::uint64_t k = 0; k < 3; ++k) {
    auto tiff = TiffWriter::create(file("pages") / ("frame-00" + std::to_string(k) + ".tiff"));
    ASSERT_TRUE(tiff.has_value());
    ASSERT_TRUE(tiff->append(frame(k).counts).has_value());
    ASSERT_TRUE(tiff->verified_pages().has_value());
  }
  overwrite(file("pages") / "notes.txt", "not a picture");

  const auto stack = open_recording(file("pages"), "");

  ASSERT_TRUE(stack.has_value()) << stack.error().message;
  ASSERT_EQ(stack->frame_count, 3u);
  for (std::uint64_t k = 0; k < 3; ++k) EXPECT_TRUE(equal(stack->read(k)->counts, frame(k).counts)) << k;
}

TEST_F(Recordings, RefuseTiffPagesOfDifferentSizeAndBrokenFiles) {
  auto tiff = TiffWriter::create(file("mixed.tif"));
  ASSERT_TRUE(tiff->append(cv::Mat1w(3, 4, std::uint16_t{1})).has_value());
  ASSERT_TRUE(tiff->append(cv::Mat1w(4, 3, std::uint16_t{1})).has_value());
  EXPECT_FALSE(tiff->verified_pages().has_value());
  overwrite(file("broken.tif"), "II*");

  EXPECT_THAT(open_recording(file("mixed.tif"), "").error().message,
              HasSubstr("page 2 is 3 x 4, but the first page is 4 x 3"));
  EXPECT_EQ(open_recording(file("broken.tif"), "").error().code, ErrorCode::invalid_input);
}

}  // namespace
}  // namespace todbench
