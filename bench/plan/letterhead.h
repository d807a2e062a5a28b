// SPDX-License-Identifier: GPL-3.0-or-later
// Letterhead of a laboratory for its reports, from a TOML file. The letterhead consists of plain text and one picture,
// so a report remains self-contained and executes no code.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/base/result.h"
#include "bench/plan/resources.h"

namespace todbench {

/// Content of a letterhead.
struct Letterhead {
  std::string title;      ///< heading of the first page; empty: title of the report
  std::string logo_png;   ///< as returned by checked_png(); empty: no logo
  std::string logo_text;  ///< alternative text of the logo
  double logo_height_mm = 14;
  std::vector<std::string> lines;         ///< name and address, next to the logo
  std::vector<std::string> introduction;  ///< paragraphs before the verdict
  std::string closing_title;
  std::vector<std::string> closing;  ///< paragraphs of a section at the end
  std::string foot;                  ///< text before the label in the footer of printed pages
  bool operator==(const Letterhead&) const = default;
};

/// Checks a PNG of at most 512 KiB and 2000 x 2000 pixels and returns it without ancillary chunks (text, times,
/// profiles and any other data). The file must be complete: checksums, and as many bytes of picture as its size
/// requires. Errors: `invalid_input` with the reason.
[[nodiscard]] Result<std::string> checked_png(std::string_view bytes);

/// Reads a description and its logo, whose path is relative to the file. Errors: `invalid_input` with file and line
/// (key unknown or out of range, text over 2000 characters, more than 20 entries of a kind, control character, invalid
/// logo).
[[nodiscard]] Result<Letterhead> parse_letterhead(const Resource& resource);
/// Reads a letterhead from a file. Errors: as parse_letterhead(); `invalid_input` if the file cannot be read.
[[nodiscard]] Result<Letterhead> load_letterhead(const std::filesystem::path& file);

/// Files of the letterhead, relative to the session folder.
inline constexpr std::string_view letterhead_file = "inputs/letterhead.toml";
inline constexpr std::string_view letterhead_logo_file = "inputs/letterhead.png";
/// Writes the files of `letterhead` and returns their names.
[[nodiscard]] Result<std::vector<std::string>> keep_letterhead(const std::filesystem::path& session,
                                                               const Letterhead& letterhead);
/// Returns the letterhead of a session; empty if it has none.
[[nodiscard]] Result<std::optional<Letterhead>> kept_letterhead(const std::filesystem::path& session);

}  // namespace todbench
