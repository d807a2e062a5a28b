// What a laboratory puts on its reports: logo, lines, texts. From a TOML file; all of it is plain text and one picture,
// so that a report stays self-contained and runs nothing.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/core/result.h"
#include "bench/plan/resources.h"

namespace todbench {

struct Letterhead {
  std::string title;      ///< over the first page; empty: that of the report
  std::string logo_png;   ///< bytes as checked_png() returns them; empty: none
  std::string logo_text;  ///< what the logo shows, for those who do not see it
  double logo_height_mm = 14;
  std::vector<std::string> lines;         ///< beside the logo: name, address
  std::vector<std::string> introduction;  ///< paragraphs before the verdict
  std::string closing_title;
  std::vector<std::string> closing;  ///< paragraphs of a section at the end
  std::string foot;                  ///< before the label at the foot of every printed page
  bool operator==(const Letterhead&) const = default;
};

/// A PNG of at most 512 KiB and 2000 x 2000 pixels, whole (checksums, and as many bytes of picture as its size wants),
/// without what is no picture: texts, times, profiles and everything else that a program may hide there.
/// `invalid_input` with the reason.
[[nodiscard]] Result<std::string> checked_png(std::string_view bytes);

/// Reads a description and the logo that it names, relative to its file. `invalid_input` with file and line for a key
/// that is unknown or out of range, a text of more than 2000 characters, more than 20 of a kind, a control character,
/// or a logo that is none.
[[nodiscard]] Result<Letterhead> parse_letterhead(const Resource& resource);
[[nodiscard]] Result<Letterhead> load_letterhead(const std::filesystem::path& file);

/// Files of a session that keep it, relative to its folder.
inline constexpr std::string_view letterhead_file = "inputs/letterhead.toml";
inline constexpr std::string_view letterhead_logo_file = "inputs/letterhead.png";
/// Writes those of `letterhead` and names them.
[[nodiscard]] Result<std::vector<std::string>> keep_letterhead(const std::filesystem::path& session,
                                                               const Letterhead& letterhead);
/// The one that a session keeps; nothing where it has none.
[[nodiscard]] Result<std::optional<Letterhead>> kept_letterhead(const std::filesystem::path& session);

}  // namespace todbench
