// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/plan/letterhead.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

#include "acquisition/base/safe_file.h"
#include "acquisition/base/try.h"
#include "bench/plan/key_types.h"
#include "bench/plan/strict_toml.h"
#include "bench/text/files.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

constexpr std::size_t most_png_bytes = std::size_t{512} * 1024;
constexpr std::uint32_t most_png_pixels = 2000;
constexpr std::size_t longest_paragraph = 2000, most_paragraphs = 20;
constexpr std::string_view png_signature = "\x89PNG\r\n\x1a\n";

std::uint32_t png_number(std::string_view bytes) {
  std::uint32_t value = 0;
  for (const char c : bytes.substr(0, 4)) value = value << 8 | static_cast<unsigned char>(c);
  return value;
}

/// IHDR (PNG, 11.2.2).
struct PngHeader {
  std::uint32_t width = 0, height = 0;
  int depth = 0, colour = 0, interlace = 0;
};

std::optional<std::size_t> png_channels(int colour) {
  constexpr std::array<std::size_t, 7> channels{1, 0, 3, 1, 2, 0, 4};
  if (colour < 0 || colour > 6 || channels[static_cast<std::size_t>(colour)] == 0) return {};
  return channels[static_cast<std::size_t>(colour)];
}

Result<PngHeader> png_header(std::string_view data) {
  const auto wrong = [](const char* why) { return fail(ErrorCode::invalid_input, why); };
  if (data.size() != 13) return wrong("the PNG has no valid header");
  PngHeader header{png_number(data), png_number(data.substr(4)), data[8], data[9], data[12]};
  if (header.width == 0 || header.height == 0 || header.width > most_png_pixels || header.height > most_png_pixels)
    return wrong("the logo must have at most 2000 x 2000 pixels");
  const std::array depths{1, 2, 4, 8, 16};
  if (std::find(depths.begin(), depths.end(), header.depth) == depths.end() || !png_channels(header.colour) ||
      data[10] != 0 || data[11] != 0)
    return wrong("the PNG is of an unknown kind");
  if (header.interlace != 0) return wrong("the PNG is interlaced: save it without interlacing");
  return header;
}

/// Returns the size of the inflated picture in bytes; each row starts with a filter byte.
std::size_t png_picture_bytes(const PngHeader& header) {
  const std::size_t bits = header.width * *png_channels(header.colour) * static_cast<std::size_t>(header.depth);
  return header.height * (1 + (bits + 7) / 8);
}

bool inflates_to(const std::string& packed, std::size_t bytes) {
  std::string plain(bytes + 1, '\0');
  uLongf size = plain.size();
  return ::uncompress(reinterpret_cast<Bytef*>(plain.data()), &size, reinterpret_cast<const Bytef*>(packed.data()),
                      packed.size()) == Z_OK &&
         size == bytes;
}

std::string paragraph_in(TomlReader& file, std::string_view key) {
  const std::string text = file.text(key, "");
  const auto is_control = [](unsigned char c) { return c < 0x20 || c == 0x7f; };
  if (text.size() > longest_paragraph || std::any_of(text.begin(), text.end(), is_control))
    file.reject(key, "expected one line of at most 2000 bytes");
  return text;
}

std::vector<std::string> paragraphs_in(TomlReader& file, std::string_view key) {
  const auto texts = file.texts(key, std::vector<std::string>{});
  if (texts.size() > most_paragraphs) file.reject(key, fmt::format("expected at most {} texts", most_paragraphs));
  const auto is_control = [](unsigned char c) { return c < 0x20 || c == 0x7f; };
  for (std::size_t i = 0; i < texts.size(); ++i) {
    if (texts[i].size() > longest_paragraph || std::any_of(texts[i].begin(), texts[i].end(), is_control))
      file.reject(key, i, "expected one line of at most 2000 bytes");
  }
  return texts;
}

Result<std::string> logo_in(const std::filesystem::path& file) {
  std::error_code problem;
  if (!std::filesystem::is_regular_file(file, problem))
    return fail(ErrorCode::invalid_input, file.string() + ": " + no_file_reason(file));
  const auto size = std::filesystem::file_size(file, problem);
  if (problem || size > most_png_bytes)
    return fail(ErrorCode::invalid_input, file.string() + ": the logo must have at most 512 KiB");
  auto bytes = read_text_file(file);
  if (!bytes) return bytes;
  auto png = checked_png(*bytes);
  if (!png) return fail(file.string(), png.error());
  return png;
}

std::string toml_of(const Letterhead& letterhead) {
  std::string text;
  const auto add = [&](std::string_view key, const std::string& value) {
    if (!value.empty()) text += fmt::format("{} = {}\n", key, toml_string(value));
  };
  const auto add_list = [&](std::string_view key, const std::vector<std::string>& values) {
    if (values.empty()) return;
    std::vector<std::string> quoted;
    for (const auto& value : values) quoted.push_back(toml_string(value));
    text += fmt::format("{} = [{}]\n", key, fmt::join(quoted, ", "));
  };
  add("title", letterhead.title);
  if (!letterhead.logo_png.empty()) {
    add("logo", std::filesystem::path(letterhead_logo_file).filename().string());
    add("logo_text", letterhead.logo_text);
    text += fmt::format("logo_height_mm = {}\n", number_text(letterhead.logo_height_mm));
  }
  add_list("lines", letterhead.lines);
  add_list("introduction", letterhead.introduction);
  add("closing_title", letterhead.closing_title);
  add_list("closing", letterhead.closing);
  add("foot", letterhead.foot);
  return text;
}

}  // namespace

Result<std::string> checked_png(std::string_view bytes) {
  const auto wrong = [](const char* why) { return fail(ErrorCode::invalid_input, why); };
  if (bytes.size() > most_png_bytes) return wrong("the logo must have at most 512 KiB");
  if (!bytes.starts_with(png_signature)) return wrong("not a PNG");
  std::string kept(png_signature), packed;
  std::optional<PngHeader> header;
  for (bytes.remove_prefix(png_signature.size());;) {
    if (bytes.size() < 12) return wrong("the PNG is truncated");
    const std::size_t size = png_number(bytes);
    if (size > bytes.size() - 12) return wrong("the PNG is truncated");
    const auto type = bytes.substr(4, 4), data = bytes.substr(8, size), whole = bytes.substr(0, size + 12);
    const auto sum = ::crc32(0, reinterpret_cast<const Bytef*>(bytes.data()) + 4, static_cast<uInt>(size + 4));
    if (png_number(bytes.substr(size + 8)) != sum) return wrong("the PNG has a wrong checksum");
    if ((type == "IHDR") == header.has_value()) return wrong("the PNG does not begin with one header");
    if (type == "IHDR") {
      TODBENCH_TRY(header, png_header(data));
    }
    if (type == "IDAT") packed += data;
    if (type == "IHDR" || type == "PLTE" || type == "tRNS" || type == "IDAT" || type == "IEND") kept += whole;
    bytes.remove_prefix(whole.size());
    if (type == "IEND") break;
  }
  if (!inflates_to(packed, png_picture_bytes(*header))) return wrong("the picture of the PNG is incomplete");
  return kept;
}

Result<Letterhead> load_letterhead(const std::filesystem::path& file) {
  TODBENCH_TRY(auto text, read_text_file(file));
  return parse_letterhead({file.string(), std::move(text)});
}

Result<Letterhead> parse_letterhead(const Resource& resource) {
  TODBENCH_TRY(auto reader, TomlReader::parse(resource.text, resource.origin));
  Letterhead letterhead;
  letterhead.title = paragraph_in(reader, "title");
  const std::string logo = reader.text("logo", "");
  letterhead.logo_text = paragraph_in(reader, "logo_text");
  letterhead.logo_height_mm = reader.number("logo_height_mm", NumberRange::between(5, 60), letterhead.logo_height_mm);
  if (logo.find("://") != std::string::npos)
    reader.reject("logo", "expected a local file: the program does not download files");
  if (!logo.empty() && letterhead.logo_text.empty())
    reader.reject("logo", "needs logo_text, a description of the logo");
  letterhead.lines = paragraphs_in(reader, "lines");
  letterhead.introduction = paragraphs_in(reader, "introduction");
  letterhead.closing_title = paragraph_in(reader, "closing_title");
  letterhead.closing = paragraphs_in(reader, "closing");
  if (letterhead.closing_title.empty() && !letterhead.closing.empty()) reader.reject("closing", "needs closing_title");
  letterhead.foot = paragraph_in(reader, "foot");
  if (letterhead.foot.size() > 80) reader.reject("foot", "expected at most 80 bytes");
  TODBENCH_TRY_VOID(reader.finish());
  if (logo.empty()) return letterhead;
  TODBENCH_TRY(letterhead.logo_png, logo_in(std::filesystem::path(resource.origin).parent_path() / logo));
  return letterhead;
}

Result<std::vector<std::string>> keep_letterhead(const std::filesystem::path& session, const Letterhead& letterhead) {
  std::vector<std::string> files{std::string(letterhead_file)};
  std::error_code problem;
  std::filesystem::create_directories(session / "inputs", problem);
  if (problem) return fail(ErrorCode::io, (session / "inputs").string() + ": cannot be created: " + problem.message());
  if (!letterhead.logo_png.empty()) {
    files.emplace_back(letterhead_logo_file);
    TODBENCH_TRY_VOID(write_file_atomically(session / files.back(), letterhead.logo_png));
  }
  TODBENCH_TRY_VOID(write_file_atomically(session / files.front(), toml_of(letterhead)));
  return files;
}

Result<std::optional<Letterhead>> kept_letterhead(const std::filesystem::path& session) {
  if (!is_there(session / letterhead_file)) return std::nullopt;
  TODBENCH_TRY(auto letterhead, load_letterhead(session / letterhead_file));
  return letterhead;
}

}  // namespace todbench
