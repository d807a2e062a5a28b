// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/recording/flir_jpeg.h"

#include <map>
#include <string_view>

namespace todbench {
namespace {

/// 256 segments of 64 KiB need 16 MiB; some programs number all of them 0.
constexpr std::size_t most_flir_bytes = std::size_t{64} << 20;
constexpr std::size_t segment_header_bytes = 8;  ///< "FLIR", 0, 1, number, last number

unsigned byte(std::string_view text, std::size_t at) {
  return static_cast<unsigned char>(text[at]);
}

/// FlirSegments by their number; those with the same number in file order.
struct FlirSegments {
  std::map<unsigned, std::string> parts;
  unsigned last = 0;
  std::size_t bytes = 0;
};

Result<std::string> joined(const FlirSegments& segments) {
  if (segments.parts.empty())
    return fail(ErrorCode::invalid_input,
                "a JPEG picture without the raw data of a FLIR camera: colours are not counts");
  std::string record;
  record.reserve(segments.bytes);
  unsigned expected = 0;
  for (const auto& [number, part] : segments.parts) {
    if (number != expected) break;
    record += part;
    ++expected;
  }
  if (expected != segments.last + 1)
    return fail(ErrorCode::invalid_input, "the JPEG picture lacks segment " + std::to_string(expected + 1) + " of " +
                                              std::to_string(segments.last + 1) + " with FLIR data");
  return record;
}

}  // namespace

Result<std::string> flir_record_of_jpeg(const FlirBytes& jpeg) {
  if (jpeg.read(0, 2) != "\xff\xd8") return fail(ErrorCode::invalid_input, "not a JPEG picture");
  constexpr unsigned app1 = 0xE1, start_of_scan = 0xDA, end_of_image = 0xD9;
  FlirSegments segments;
  for (std::uint64_t at = 2;;) {
    const std::string head = jpeg.read(at, 4 + segment_header_bytes);
    if (head.size() < 4 || byte(head, 0) != 0xFF) break;
    const unsigned marker = byte(head, 1);
    if (marker == 0xFF) {  // fill byte
      ++at;
      continue;
    }
    if (marker == start_of_scan || marker == end_of_image) break;
    const std::size_t length = byte(head, 2) << 8 | byte(head, 3);
    if (length < 2) break;
    const std::string_view name = std::string_view(head).substr(4);
    if (marker == app1 && length >= 2 + segment_header_bytes && name.size() == segment_header_bytes &&
        name.starts_with(std::string_view("FLIR\0", 5))) {
      segments.last = std::max(segments.last, byte(name, 7));
      const std::size_t payload = length - 2 - segment_header_bytes;
      segments.bytes += payload;
      if (segments.bytes > most_flir_bytes)
        return fail(ErrorCode::invalid_input, "the JPEG picture has too much FLIR data");
      segments.parts[byte(name, 6)] += jpeg.read(at + 4 + segment_header_bytes, payload);
    }
    at += 2 + length;
  }
  return joined(segments);
}

}  // namespace todbench
