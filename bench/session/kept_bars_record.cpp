// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/session/kept_bars_record.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <utility>

#include "acquisition/base/try.h"
#include "bench/session/measure_pictures.h"
#include "bench/text/files.h"
#include "bench/text/folders.h"
#include "bench/text/json_file.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

constexpr int most_side_px = 4096;  // of a record that may have been edited

std::filesystem::path index_file(const std::filesystem::path& session) {
  return session / pictures_folder / "mrtd-bars.json";
}

void place_fields(JsonFields& json, KeptPlace& place) {
  json.value("name", place.name);
  json.value("axis", place.axis, std::array{EdgeAxis::x, EdgeAxis::y});
  json.value("frequency_per_pitch", place.frequency_per_pitch);
  json.value("size_px", place.size_px);
  json.value("side_px", place.side_px);
}

void picture_fields(JsonFields& json, KeptPicture& picture) {
  json.value("place", picture.place);
  json.value("set_up", picture.set_up);
  json.value("contrast_k", picture.contrast_k);
}

void kept_fields(JsonFields& json, KeptBars& kept) {
  json.value("places", kept.places, place_fields);
  json.value("pictures", kept.pictures, picture_fields);
}

static_assert(std::endian::native == std::endian::little, "samples are stored as they are in memory");

void append(std::string& bytes, const cv::Mat1f& window) {
  for (int row = 0; row < window.rows; ++row)
    bytes.append(reinterpret_cast<const char*>(window.ptr<float>(row)), sizeof(float) * std::size_t(window.cols));
}

/// Takes a window from the front of the samples; empty if they are too short or not finite.
cv::Mat1f taken(std::string_view& bytes, int side) {
  cv::Mat1f window(side, side);
  const std::size_t length = sizeof(float) * window.total();
  if (bytes.size() < length) return {};
  std::memcpy(window.data, bytes.data(), length);
  bytes.remove_prefix(length);
  return cv::checkRange(window) ? window : cv::Mat1f();
}

}  // namespace

std::filesystem::path kept_bars_file(const std::filesystem::path& session) {
  return session / pictures_folder / "mrtd-bars.f32";
}

Result<void> write_kept_bars(const std::filesystem::path& session, const KeptBars& kept) {
  TODBENCH_TRY_VOID(make_folder(session / pictures_folder));
  std::string samples;
  for (const KeptPicture& picture : kept.pictures) append(samples, picture.target), append(samples, picture.other);
  TODBENCH_TRY_VOID(write_file_atomically(kept_bars_file(session), samples));
  KeptBars index = kept;
  return write_json_file(index_file(session), json_of(index, kept_fields));
}

Result<std::optional<KeptBars>> read_kept_bars(const std::filesystem::path& session) {
  if (!is_there(index_file(session))) return std::nullopt;
  const std::string name = index_file(session).string();
  TODBENCH_TRY(KeptBars kept, read_record_file<KeptBars>(index_file(session), kept_fields));
  TODBENCH_TRY(const std::string samples, read_text_file(kept_bars_file(session)));
  std::string_view left = samples;
  for (KeptPicture& picture : kept.pictures) {
    if (picture.place >= kept.places.size() || !std::isfinite(picture.contrast_k) || picture.contrast_k == 0)
      return fail(ErrorCode::invalid_input, name + ": a picture without a place or a contrast");
    const int side = kept.places[picture.place].side_px;
    if (side < 1 || side > most_side_px) return fail(ErrorCode::invalid_input, name + ": 'side_px' is out of range");
    picture.target = taken(left, side);
    picture.other = taken(left, side);
    if (picture.target.empty() || picture.other.empty())
      return fail(ErrorCode::invalid_input, kept_bars_file(session).string() + ": does not fit " + name);
  }
  if (!left.empty())
    return fail(ErrorCode::invalid_input, kept_bars_file(session).string() + ": is longer than " + name + " states");
  return kept;
}

}  // namespace todbench
