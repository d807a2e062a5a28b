// SPDX-License-Identifier: GPL-3.0-or-later
// Creation and opening of all files of todbench. Writers never follow a link; readers never wait for a pipe.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string_view>

#include "acquisition/base/result.h"

namespace todbench {

/// A newly created file.
struct NewFile {
  int descriptor = -1;         ///< for reading and writing; the caller closes it
  std::filesystem::path path;  ///< the caller removes or renames it
};

/// Creates an empty file with a random hidden name (".NAME.XXXXXXXXXXXXXXXX.part") in the folder of `file`. An existing
/// file is never opened. Error: `io` with the path of `file` and the reason.
[[nodiscard]] Result<NewFile> make_file_beside(const std::filesystem::path& file, mode_t mode = 0666);
/// Returns whether make_file_beside() creates names of this form. A killed program leaves files with these names.
[[nodiscard]] bool is_name_of_a_part(const std::filesystem::path& file);

/// Creates an empty file of this name for reading and writing. An existing file or link is replaced; the target of a
/// link stays unchanged. A character device is opened if it is named directly. Error: `io` with path and reason, also
/// for a folder, a pipe or a socket. The caller closes the descriptor.
[[nodiscard]] Result<int> make_empty_file(const std::filesystem::path& file, mode_t mode = 0666);

/// Opens or creates a regular file for appending. A link is refused. Errors as make_empty_file().
[[nodiscard]] Result<int> open_to_append(const std::filesystem::path& file);

/// Opens a regular file for reading, without waiting. Links are followed. A name below /dev or /proc may also lead to a
/// pipe or a device ("/dev/stdin"); reading it may block. Error: `io` with path and reason. The caller closes the
/// descriptor.
[[nodiscard]] Result<int> open_to_read(const std::filesystem::path& file);

/// Returns the reason why a path is not a regular file: "no such file", "it is a folder" or "it is a pipe, a socket or
/// a device".
[[nodiscard]] std::string no_file_reason(const std::filesystem::path& file);

/// Writes all of `content`, even if writes are interrupted or partial. Returns 0 or the error number.
[[nodiscard]] int write_all(int descriptor, std::string_view content);

}  // namespace todbench
