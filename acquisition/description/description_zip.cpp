// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/description/description_zip.h"

#include <zlib.h>

#include <optional>

#include "acquisition/base/try.h"

namespace todbench {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::uint32_t end_of_directory_mark = 0x06054b50;
constexpr std::uint32_t directory_entry_mark = 0x02014b50;
constexpr std::uint32_t local_header_mark = 0x04034b50;
constexpr std::size_t end_of_directory_bytes = 22, directory_entry_bytes = 46, local_header_bytes = 30;

std::uint64_t little_endian(Bytes bytes, std::size_t at, std::size_t count) {
  std::uint64_t value = 0;
  for (std::size_t i = count; i-- > 0;) value = value << 8 | bytes[at + i];
  return value;
}

bool fits(Bytes archive, std::uint64_t at, std::uint64_t count) {
  return at <= archive.size() && count <= archive.size() - at;
}

/// Finds the end of the directory as the client does: the last mark in the archive.
std::optional<std::size_t> end_of_directory(Bytes archive) {
  if (archive.size() < end_of_directory_bytes) return std::nullopt;
  for (std::size_t at = archive.size() - 4; at > 0; --at) {
    if (little_endian(archive, at, 4) != end_of_directory_mark) continue;
    return fits(archive, at, end_of_directory_bytes) ? std::optional(at) : std::nullopt;
  }
  return std::nullopt;
}

struct Member {
  std::uint64_t data = 0, packed = 0, unpacked = 0;
};

/// Finds the file that the client uses: the last entry of the directory.
Result<Member> find_member(Bytes archive) {
  const auto refused = [] { return fail(ErrorCode::not_found, "the zipped description is damaged"); };
  const auto end = end_of_directory(archive);
  if (!end) return refused();
  const std::uint64_t files = little_endian(archive, *end + 10, 2);
  const std::uint64_t directory_bytes = little_endian(archive, *end + 12, 4);
  const std::uint64_t directory = little_endian(archive, *end + 16, 4);
  if (files != 1 || little_endian(archive, *end + 8, 2) != files) {
    return fail(ErrorCode::not_found, "the zipped description has " + std::to_string(files) + " files instead of one");
  }
  // Offsets count from the end of any data in front of the archive.
  if (directory + directory_bytes > *end) return refused();
  const std::uint64_t before = *end - (directory + directory_bytes);
  const std::uint64_t entry = before + directory;
  if (!fits(archive, entry, directory_entry_bytes) || little_endian(archive, entry, 4) != directory_entry_mark) {
    return refused();
  }
  if (!fits(archive, entry + directory_entry_bytes, little_endian(archive, entry + 28, 2))) return refused();
  const std::uint64_t local = before + little_endian(archive, entry + 42, 4);
  if (!fits(archive, local, local_header_bytes) || little_endian(archive, local, 4) != local_header_mark) {
    return refused();
  }
  const Member member{.data = local + local_header_bytes + little_endian(archive, local + 26, 2) +
                              little_endian(archive, local + 28, 2),
                      .packed = little_endian(archive, entry + 20, 4),
                      .unpacked = little_endian(archive, entry + 24, 4)};
  if (!fits(archive, member.data, member.packed)) return refused();
  return member;
}

}  // namespace

Result<std::string> unzip_description(Bytes archive, std::size_t most_bytes) {
  TODBENCH_TRY(const auto member, find_member(archive));
  if (member.unpacked == 0 || member.unpacked > most_bytes) {
    return fail(ErrorCode::not_found, "the zipped description states " + std::to_string(member.unpacked) +
                                          " bytes; at most " + std::to_string(most_bytes) + " are accepted");
  }
  const Bytes packed = archive.subspan(member.data, member.packed);
  if (member.packed > member.unpacked) return fail(ErrorCode::not_found, "the zipped description is damaged");
  // The client treats data that is not smaller than its file as stored.
  if (member.packed == member.unpacked) return std::string(packed.begin(), packed.end());
  std::string out(member.unpacked, '\0');
  z_stream stream{};
  if (inflateInit2(&stream, -MAX_WBITS) != Z_OK) return fail(ErrorCode::internal, "zlib cannot be used");
  stream.next_in = const_cast<Bytef*>(packed.data());
  stream.avail_in = static_cast<uInt>(packed.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  const int ended = inflate(&stream, Z_FINISH);
  const bool whole = ended == Z_STREAM_END && stream.avail_out == 0;
  inflateEnd(&stream);
  if (!whole)
    return fail(ErrorCode::not_found,
                "the unpacked size of the zipped description differs from the size that it states");
  return out;
}

}  // namespace todbench
