// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/recording/file_content.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "acquisition/recording/flir_record.h"
#include "acquisition/recording/flir_seq.h"
#include "acquisition/recording/frame_stream.h"

namespace todbench {
namespace {

using namespace std::string_view_literals;

/// Bytes at a place that show a format which is not read as a recording.
struct Signature {
  std::size_t at;
  std::string_view bytes;
  std::string_view name;
};

/// At least four bytes each: raw counts begin with any two.
constexpr std::array signatures{
    Signature{0, "\x89PNG\r\n\x1a\n"sv, "a PNG picture"},
    Signature{0, "\x93NUMPY"sv, "a NumPy array"},
    Signature{0, "\x89HDF\r\n\x1a\n"sv, "an HDF5 file"},
    Signature{0, "FPF Public Image"sv, "a FLIR Public Image (FPF)"},
    Signature{0, "\xed\xfe\0\0N"sv, "a NorPix sequence"},
    Signature{0, "SIMPLE  ="sv, "a FITS picture"},
    Signature{0, "GIF8"sv, "a GIF picture"},
    Signature{0, "PK\x03\x04"sv, "a ZIP archive"},
    Signature{0, "%PDF"sv, "a PDF document"},
    Signature{0, "\x1a\x45\xdf\xa3"sv, "a Matroska video"},
    Signature{4, "ftyp"sv, "an MP4 or QuickTime video"},
    Signature{8, "AVI "sv, "an AVI video"},
    Signature{0, "CPTV"sv, "a CPTV recording"},
};

bool is_tiff(std::string_view start) {
  constexpr std::array magic{"II*\0"sv, "MM\0*"sv, "II+\0"sv, "MM\0+"sv};
  return std::any_of(magic.begin(), magic.end(), [&](std::string_view bytes) { return start.starts_with(bytes); });
}

}  // namespace

FileContent content_of_file(const std::filesystem::path& path) {
  if (is_frame_stream(path)) return {FileKind::frame_stream};
  const auto file = FlirBytes::of_file(path);
  if (!file) return {};
  const std::string start = file->read(0, 16);
  if (is_flir_file(start)) return {FileKind::flir};
  if (is_tiff(start)) return {FileKind::tiff};
  for (const Signature& signature : signatures) {
    if (start.size() >= signature.at && std::string_view(start).substr(signature.at).starts_with(signature.bytes))
      return {FileKind::foreign, std::string(signature.name)};
  }
  FileContent content;
  for (const char c : std::string_view(start).substr(0, 8))
    content.start += fmt::format("{}{:02x}", content.start.empty() ? "" : " ", static_cast<unsigned char>(c));
  return content;
}

}  // namespace todbench
