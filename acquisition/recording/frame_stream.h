// Recordings as the bench writes them: everything a camera delivered, appended as it came. Format: docs/recordings.md.
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

/// What a recording begins with.
struct StreamHeader {
  SourceInfo info;  ///< of the camera, as read back when the recording began
  std::string created_utc;
  std::int64_t created_host_ns = 0;                ///< CLOCK_MONOTONIC at `created_utc`
  std::map<std::string, std::string> annotations;  ///< what else is to be known, e.g. what changed the target
};

/// An answer that the measuring program got beside its frames: what it had asked for, and what it was told.
struct Reading {
  std::string tag;    ///< without a space; empty: damaged in the file
  std::string value;  ///< numbers as text
  bool operator==(const Reading&) const = default;
};

/// Appends to a recording. Every record is handed to the system whole, with checksums, before the call returns: a crash
/// of the program loses nothing, one of the machine at most what the system had not written yet. Move-only; several
/// threads may append, each record is whole. Errors: `io` with the path; what a full disk cut off is taken back, and
/// nothing is appended any more: a recording has no holes. Nothing is appended to a file that was deleted either.
class FrameStreamWriter {
 public:
  /// Creates the file or empties it.
  [[nodiscard]] static Result<FrameStreamWriter> create(const std::filesystem::path& file, const StreamHeader& header);
  FrameStreamWriter(FrameStreamWriter&&) noexcept = default;
  FrameStreamWriter& operator=(FrameStreamWriter&&) noexcept = default;

  /// A frame as it came, whatever its status; `invalid_input` for one of more than 2^29 pixels.
  [[nodiscard]] Result<void> append(const Frame& frame);
  /// Instead of a frame, or of a correction, the camera failed.
  [[nodiscard]] Result<void> append_failure(const Error& error, FailedCall call);
  /// What the measuring program was told between two frames; `invalid_input` for a tag that is empty or has a space, or
  /// more than 64 KiB.
  [[nodiscard]] Result<void> append_reading(const Reading& reading);
  /// Waits until everything is on the disk, and fails unless it is where it was created.
  [[nodiscard]] Result<void> sync();
  /// sync(), and opens the file again: what a reader finds in it. Fails unless that is what was appended.
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
  std::optional<Error> refused_;                                            ///< why nothing is appended any more
  std::unique_ptr<std::mutex> appending_ = std::make_unique<std::mutex>();  ///< guards all of it
};

/// An opened recording. Readings and failures are in their order; a failure stands before the frame with its index.
struct FrameStream {
  StreamHeader header;
  Recording recording;
  std::vector<Reading> readings;
  std::uint64_t torn_bytes = 0;  ///< behind the last whole record: what a crash left of the next one
};

/// Whether a file begins like a recording of the bench.
[[nodiscard]] bool is_frame_stream(const std::filesystem::path& file);

/// Finds every record; pixels are read when they are asked for. A frame whose checksum does not fit is served as
/// incomplete. Errors: `io`, `invalid_input` (not such a file, or damaged before its first record).
[[nodiscard]] Result<FrameStream> open_frame_stream(const std::filesystem::path& file);

}  // namespace todbench
