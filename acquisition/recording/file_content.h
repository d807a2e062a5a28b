// SPDX-License-Identifier: GPL-3.0-or-later
// Kind of a file, determined by its first bytes. File names are not used, because cameras and programs use one suffix
// for several formats.
#pragma once

#include <filesystem>
#include <string>

namespace todbench {

/// Kinds of files that are offered as recordings.
enum class FileKind {
  frame_stream,  ///< a recording of the bench
  flir,          ///< FFF records, or a JPEG picture that may contain an FFF record
  tiff,
  foreign,  ///< a known format that cannot be opened as a recording
  unknown,  ///< no known first bytes: raw counts, or a damaged file
};

/// Content of a file.
struct FileContent {
  FileKind kind = FileKind::unknown;
  std::string name{};   ///< name of a foreign format, with its article: "a PNG picture"
  std::string start{};  ///< the first bytes of an unknown file, as hexadecimal digits
};

/// Reads the first bytes. An unreadable file is `unknown`; opening it returns the reason.
[[nodiscard]] FileContent content_of_file(const std::filesystem::path& path);

}  // namespace todbench
