// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/recording/frame_stream.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cstring>
#include <memory>
#include <optional>
#include <utility>

#include "acquisition/base/descriptor.h"
#include "acquisition/base/safe_file.h"
#include "acquisition/base/system_reason.h"
#include "acquisition/base/try.h"
#include "acquisition/core/camera_id.h"
#include "acquisition/recording/stream_header.h"

namespace todbench {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers are stored as they lie in memory");

constexpr char magic[] = "TODBREC1";
constexpr std::size_t magic_bytes = 8;

/// Head of every record: kind, length, and checksums of this head and of the payload.
struct RecordHead {
  std::array<char, 4> kind{};
  std::uint32_t payload_bytes = 0;
  std::uint32_t head_crc = 0;  ///< of the two fields above
  std::uint32_t payload_crc = 0;
};
static_assert(sizeof(RecordHead) == 16);

/// Head of a frame's pixels.
struct FrameHead {
  std::uint64_t sequence = 0;
  std::int64_t device_time_ns = 0;
  std::int64_t host_time_ns = 0;
  double since_correction_s = -1;
  std::uint16_t width = 0, height = 0;
  std::uint8_t status = 0, correction = 0, significant_bits = 16, numbering = 0;
};
static_assert(sizeof(FrameHead) == 40);

constexpr std::uint32_t most_payload = std::uint32_t{1} << 30;
constexpr std::uint32_t most_header = std::uint32_t{1} << 20;
constexpr std::uint32_t most_failure = std::uint32_t{1} << 16;
constexpr std::uint32_t most_reading = std::uint32_t{1} << 16;

std::uint32_t crc_of(const void* data, std::size_t bytes, std::uint32_t start = 0) {
  // Lengths are below 2^31, and zlib accepts 32-bit lengths.
  return static_cast<std::uint32_t>(::crc32(start, static_cast<const Bytef*>(data), static_cast<uInt>(bytes)));
}

std::uint32_t crc_of(const RecordHead& head) {
  return crc_of(&head, offsetof(RecordHead, head_crc));
}

/// An open file that closes itself.
class File {
 public:
  explicit File(int descriptor) : descriptor_(descriptor) {}
  [[nodiscard]] bool open() const { return descriptor_.is_open(); }
  [[nodiscard]] std::uint64_t size() const {
    struct stat facts {};
    return ::fstat(descriptor_.get(), &facts) == 0 && facts.st_size > 0 ? static_cast<std::uint64_t>(facts.st_size) : 0;
  }
  /// Reads all bytes; otherwise false.
  [[nodiscard]] bool read(std::uint64_t offset, void* to, std::size_t bytes) const {
    auto* at = static_cast<char*>(to);
    while (bytes > 0) {
      const ssize_t got = ::pread(descriptor_.get(), at, bytes, static_cast<off_t>(offset));
      if (got < 0 && errno == EINTR) continue;
      if (got <= 0) return false;
      at += got;
      offset += static_cast<std::uint64_t>(got);
      bytes -= static_cast<std::size_t>(got);
    }
    return true;
  }

 private:
  Descriptor descriptor_;
};

/// Position of a frame in the file.
struct FramePlace {
  std::uint64_t offset = 0;  ///< of its payload
  RecordHead head;
};

bool plausible(const FrameHead& head, std::uint32_t payload_bytes) {
  return payload_bytes == sizeof(FrameHead) + std::size_t{2} * head.width * head.height && head.status <= 2 &&
         head.correction <= 2 && head.numbering <= 3 && head.significant_bits >= 1 && head.significant_bits <= 16;
}

Result<RecordedFrame> read_frame(const File& file, const FramePlace& place) {
  FrameHead head;
  if (!file.read(place.offset, &head, sizeof head))
    return fail(ErrorCode::io, "the file became shorter after it was opened");
  RecordedFrame frame;
  if (!plausible(head, place.head.payload_bytes)) {
    frame.status = FrameStatus::incomplete;
    return frame;
  }
  const std::size_t pixel_bytes = place.head.payload_bytes - sizeof head;
  if (pixel_bytes > 0) {
    frame.counts.create(head.height, head.width);
    if (!file.read(place.offset + sizeof head, frame.counts.data, pixel_bytes))
      return fail(ErrorCode::io, "the file became shorter after it was opened");
  }
  std::uint32_t crc = crc_of(&head, sizeof head);
  if (pixel_bytes > 0) crc = crc_of(frame.counts.data, pixel_bytes, crc);
  if (crc != place.head.payload_crc) {
    frame.status = FrameStatus::incomplete;
    return frame;
  }
  frame.sequence = head.sequence;
  frame.device_time_ns = head.device_time_ns;
  frame.host_time_ns = head.host_time_ns;
  frame.since_correction_s = head.since_correction_s;
  frame.correction = static_cast<CorrectionState>(head.correction);
  frame.significant_bits = head.significant_bits;
  frame.status = static_cast<FrameStatus>(head.status);
  frame.numbering = static_cast<Numbering>(head.numbering);
  return frame;
}

std::string payload_text(const File& file, std::uint64_t offset, std::size_t bytes) {
  std::string text(bytes, '\0');
  if (!file.read(offset, text.data(), bytes)) text.clear();
  return text;
}

/// Reads the records of a file and sorts them by kind.
class StreamIndex {
 public:
  StreamIndex(const File& file, std::uint64_t size) : file_(file), size_(size) {}

  Result<void> walk() {
    while (size_ - at_ >= sizeof(RecordHead)) {
      RecordHead head;
      if (!file_.read(at_, &head, sizeof head)) break;
      if (head.head_crc != crc_of(head) || head.payload_bytes > size_ - at_ - sizeof head) break;
      TODBENCH_TRY_VOID(take(head, at_ + sizeof head));
      at_ += sizeof head + head.payload_bytes;
    }
    return {};
  }

  std::optional<StreamHeader> header;
  std::vector<FramePlace> frames;
  std::vector<RecordedFailure> failures;
  std::vector<Reading> readings;
  [[nodiscard]] std::uint64_t torn_bytes() const { return size_ - at_; }

 private:
  [[nodiscard]] static bool is(const RecordHead& head, const char (&kind)[5]) {
    return std::memcmp(head.kind.data(), kind, 4) == 0;
  }

  Result<void> take(const RecordHead& head, std::uint64_t offset) {
    if (is(head, "FRAM") && head.payload_bytes >= sizeof(FrameHead) && head.payload_bytes <= most_payload) {
      frames.push_back({offset, head});
      return {};
    }
    // Unknown kinds are from a later version and are ignored.
    const bool header_record = is(head, "HEAD") && !header && head.payload_bytes <= most_header;
    const bool correction_record = is(head, "FCOR");
    const bool failure_record =
        (is(head, "FAIL") || correction_record) && head.payload_bytes >= 4 && head.payload_bytes <= most_failure;
    const bool reading_record = is(head, "TOLD") && head.payload_bytes <= most_reading;
    if (!header_record && !failure_record && !reading_record) return {};
    const std::string payload = payload_text(file_, offset, head.payload_bytes);
    if (crc_of(payload.data(), payload.size()) != head.payload_crc || payload.size() != head.payload_bytes) {
      // An omitted reading would put the next one in its place.
      if (reading_record) readings.emplace_back();
      return header_record ? Result<void>(fail(ErrorCode::invalid_input, "the header is damaged")) : Result<void>();
    }
    if (header_record) {
      TODBENCH_TRY(header, parse_stream_header(payload));
    } else if (failure_record) {
      std::uint32_t code = 0;
      std::memcpy(&code, payload.data(), 4);
      const auto last = static_cast<std::uint32_t>(ErrorCode::internal);
      failures.push_back({.before_frame = frames.size(),
                          .error = {static_cast<ErrorCode>(std::min(code, last)), payload.substr(4)},
                          .call = correction_record ? FailedCall::correct_nonuniformity : FailedCall::next});
    } else {
      const std::size_t space = std::min(payload.find(' '), payload.size());
      readings.push_back({payload.substr(0, space), payload.substr(std::min(space + 1, payload.size()))});
    }
    return {};
  }

  const File& file_;
  std::uint64_t size_;
  std::uint64_t at_ = magic_bytes;
};

}  // namespace

Result<FrameStreamWriter> FrameStreamWriter::create(const std::filesystem::path& path, const StreamHeader& header) {
  TODBENCH_TRY(auto file, WrittenFile::create(path));
  FrameStreamWriter writer(std::move(file));
  TODBENCH_TRY_VOID(writer.file_.append(magic, magic_bytes));
  const std::string text = stream_header_text(header);
  TODBENCH_TRY_VOID(writer.write_record("HEAD", text.data(), text.size(), nullptr, 0));
  return writer;
}

Result<void> FrameStreamWriter::write_record(const char (&kind)[5], const void* head, std::size_t head_bytes,
                                             const void* body, std::size_t body_bytes) {
  const std::lock_guard lock(*appending_);
  if (refused_) return tl::unexpected(*refused_);
  RecordHead record;
  std::memcpy(record.kind.data(), kind, 4);
  record.payload_bytes = static_cast<std::uint32_t>(head_bytes + body_bytes);
  record.head_crc = crc_of(record);
  record.payload_crc = crc_of(head, head_bytes);
  if (body_bytes > 0) record.payload_crc = crc_of(body, body_bytes, record.payload_crc);
  const std::uint64_t before = bytes();
  Result<void> written = file_.check_present();
  if (written) written = file_.append(&record, sizeof record);
  if (written) written = file_.append(head, head_bytes);
  if (written && body_bytes > 0) written = file_.append(body, body_bytes);
  if (written) return {};
  refused_ = written.error();
  file_.cut(before);
  return written;
}

Result<void> FrameStreamWriter::append(const Frame& frame) {
  const std::size_t pixel_bytes = frame.counts.total() * 2;
  if (pixel_bytes > most_payload - sizeof(FrameHead) || frame.counts.cols > 65535 || frame.counts.rows > 65535) {
    return fail(ErrorCode::invalid_input, "a frame of " + std::to_string(frame.counts.cols) + " x " +
                                              std::to_string(frame.counts.rows) + " is too large to be recorded");
  }
  FrameHead head;
  head.sequence = frame.sequence;
  head.device_time_ns = frame.device_time_ns;
  head.host_time_ns = frame.host_time_ns;
  head.since_correction_s = frame.since_correction_s;
  head.width = static_cast<std::uint16_t>(frame.counts.cols);
  head.height = static_cast<std::uint16_t>(frame.counts.rows);
  head.status = static_cast<std::uint8_t>(frame.status);
  head.correction = static_cast<std::uint8_t>(frame.correction);
  head.significant_bits = static_cast<std::uint8_t>(frame.significant_bits);
  head.numbering = static_cast<std::uint8_t>(frame.numbering);
  const cv::Mat1w pixels = frame.counts.isContinuous() ? frame.counts : cv::Mat1w(frame.counts.clone());
  auto written = write_record("FRAM", &head, sizeof head, pixels.data, pixel_bytes);
  const std::lock_guard lock(*appending_);
  if (written) ++frames_;
  return written;
}

Result<void> FrameStreamWriter::append_failure(const Error& error, FailedCall call) {
  const auto code = static_cast<std::uint32_t>(error.code);
  const std::string message = error.message.substr(0, most_failure - 4);
  return call == FailedCall::next ? write_record("FAIL", &code, sizeof code, message.data(), message.size())
                                  : write_record("FCOR", &code, sizeof code, message.data(), message.size());
}

Result<void> FrameStreamWriter::append_reading(const Reading& reading) {
  const std::string text = reading.tag + " " + reading.value;
  if (reading.tag.empty() || reading.tag.find(' ') != std::string::npos || text.size() > most_reading)
    return fail(
        ErrorCode::invalid_input,
        "the reading '" + reading.tag + "' cannot be recorded: its tag has a blank or is empty, or it is too long");
  return write_record("TOLD", text.data(), text.size(), nullptr, 0);
}

Result<void> FrameStreamWriter::sync() {
  const std::lock_guard lock(*appending_);
  return file_.sync();
}

Result<std::uint64_t> FrameStreamWriter::verified_frames() {
  TODBENCH_TRY_VOID(sync());
  const auto again = open_frame_stream(path());
  if (!again) return fail("reading the file back", with_code(ErrorCode::io, again.error()));
  if (again->recording.frame_count != frames_ || again->torn_bytes > 0) {
    return fail(ErrorCode::io, path().string() + ": holds " + std::to_string(again->recording.frame_count) +
                                   " frames, but " + std::to_string(frames_) + " were written");
  }
  return frames_;
}

bool is_frame_stream(const std::filesystem::path& path) {
  const File file(open_to_read(path).value_or(-1));
  char begin[magic_bytes] = {};
  return file.open() && file.read(0, begin, sizeof begin) && std::memcmp(begin, magic, magic_bytes) == 0;
}

Result<FrameStream> open_frame_stream(const std::filesystem::path& path) {
  const std::string name = path.string();
  TODBENCH_TRY(const auto opened, open_to_read(path));
  const auto file = std::make_shared<const File>(opened);
  if (!is_frame_stream(path)) return fail(ErrorCode::invalid_input, name + ": not a recording of todbench");
  StreamIndex index(*file, file->size());
  if (auto walked = index.walk(); !walked) return fail(name, walked.error());
  if (!index.header) return fail(ErrorCode::invalid_input, name + ": the recording has no header");
  FrameStream stream;
  stream.header = *std::move(index.header);
  stream.readings = std::move(index.readings);
  stream.torn_bytes = index.torn_bytes();
  stream.recording.info = stream.header.info;
  stream.recording.info.id = camera_id(camera_scheme::file, name);
  stream.recording.info.transport = "recording";
  if (stream.torn_bytes > 0) {
    stream.recording.info.warnings.push_back("the recording is truncated: " + std::to_string(stream.torn_bytes) +
                                             " bytes after its last complete frame are ignored");
  }
  stream.recording.frame_count = index.frames.size();
  stream.recording.failures = std::move(index.failures);
  stream.recording.read = [file, places = std::make_shared<const std::vector<FramePlace>>(std::move(index.frames))](
                              std::uint64_t i) { return read_frame(*file, (*places)[i]); };
  return stream;
}

}  // namespace todbench
