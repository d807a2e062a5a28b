// SPDX-License-Identifier: GPL-3.0-or-later
// Recordings of the bench: all frames and failures of a camera, appended in order of arrival. Format:
// docs/reference/recordings.md.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "acquisition/core/frame_source.h"
#include "acquisition/recording/recorded_source.h"
#include "acquisition/recording/written_file.h"

namespace todbench {

/// Start of a recording.
struct StreamHeader {
  SourceInfo info;  ///< description of the camera, as read back when the recording began
  std::string created_utc;
  std::int64_t created_host_ns = 0;                ///< CLOCK_MONOTONIC at `created_utc`
  std::map<std::string, std::string> annotations;  ///< additional information, e.g. about changes of the target
};

/// A question of the measuring program during the recording, and the answer that it received.
struct Reading {
  std::string tag;    ///< the question, without spaces; empty if it is damaged in the file
  std::string value;  ///< the answer; numbers as text
  bool operator==(const Reading&) const = default;
};

/// Appends to a recording. Every record is complete, has checksums, and is passed to the operating system before the
/// call returns. If the program crashes, no record is lost. If the machine crashes, only the records that the system
/// had not yet written are lost. Move-only; several threads may append. Errors: `io` with the path. After a failed
/// write (full disk, deleted file) the partial record is removed and later records are refused. A recording therefore
/// has no gaps.
class FrameStreamWriter {
 public:
  /// Creates or truncates the file.
  [[nodiscard]] static Result<FrameStreamWriter> create(const std::filesystem::path& file, const StreamHeader& header);
  FrameStreamWriter(FrameStreamWriter&&) noexcept = default;
  FrameStreamWriter& operator=(FrameStreamWriter&&) noexcept = default;

  /// Appends a frame of any status; `invalid_input` if it has more than 2^29 pixels.
  [[nodiscard]] Result<void> append(const Frame& frame);
  /// Appends a failure of the camera in place of a frame or a correction.
  [[nodiscard]] Result<void> append_failure(const Error& error, FailedCall call);
  /// Appends a reply received between two frames. Error: `invalid_input` if the tag is empty or contains a space, or
  /// for more than 64 KiB.
  [[nodiscard]] Result<void> append_reading(const Reading& reading);
  /// Waits until everything is on the disk. Fails if the file is no longer at its path.
  [[nodiscard]] Result<void> sync();
  /// Calls sync() and reads the file again. Returns the number of frames; fails if it differs from the number appended.
  [[nodiscard]] Result<std::uint64_t> verified_frames();

  [[nodiscard]] std::uint64_t frames() const { return frames_; }
  [[nodiscard]] std::uint64_t bytes() const { return file_.bytes(); }
  [[nodiscard]] const std::filesystem::path& path() const { return file_.path(); }

 private:
  explicit FrameStreamWriter(WrittenFile file) : file_(std::move(file)) {}
  [[nodiscard]] Result<void> write_record(const char (&kind)[5], const void* head, std::size_t head_bytes,
                                          const void* body, std::size_t body_bytes);

  WrittenFile file_;
  std::uint64_t frames_ = 0;
  std::optional<Error> refused_;  ///< the error after which all later records are refused
  std::unique_ptr<std::mutex> appending_ = std::make_unique<std::mutex>();  ///< guards all other members
};

/// An opened recording. Readings and failures are in order. The index of a failure is that of the next frame.
struct FrameStream {
  StreamHeader header;
  Recording recording;
  std::vector<Reading> readings;
  std::uint64_t torn_bytes = 0;  ///< bytes after the last complete record, from a record that a crash interrupted
};

/// Returns whether the first bytes of a file are those of a recording of the bench.
[[nodiscard]] bool is_frame_stream(const std::filesystem::path& file);

/// Finds all records; pixels are read on demand. A frame with a wrong checksum is returned as incomplete. Errors: `io`,
/// `invalid_input` (not a recording of the bench, or damaged before its first record).
[[nodiscard]] Result<FrameStream> open_frame_stream(const std::filesystem::path& file);

}  // namespace todbench
