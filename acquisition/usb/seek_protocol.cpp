// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/usb/seek_protocol.h"

#include <algorithm>
#include <string>

#include "acquisition/core/camera_id.h"

namespace todbench {
namespace {

const SeekGeometry compact_geometry{.product_id = 0x0010,
                                    .raw_width = 208,
                                    .raw_height = 156,
                                    .picture = {0, 1, 207, 154},
                                    .kind_word = 10,
                                    .counter_word = 40,
                                    .temperature_word = 1};
const SeekGeometry pro_geometry{.product_id = 0x0011,
                                .raw_width = 342,
                                .raw_height = 260,
                                .picture = {1, 4, 320, 240},
                                .kind_word = 2,
                                .counter_word = 1,
                                .temperature_word = 5};

std::uint16_t word(std::span<const std::uint8_t> bytes, std::size_t index) {
  return static_cast<std::uint16_t>(bytes[2 * index] | bytes[2 * index + 1] << 8U);
}

using Bytes = std::vector<std::uint8_t>;

SeekTransfer settings_at(std::uint8_t words, std::uint16_t address) {
  return {SeekRequest::set_factory_settings_features,
          {words, 0, static_cast<std::uint8_t>(address & 0xFFU), static_cast<std::uint8_t>(address >> 8U), 0, 0}};
}

void read_settings(std::vector<SeekTransfer>& transfers, std::uint8_t words, std::uint16_t address) {
  transfers.push_back(settings_at(words, address));
  transfers.push_back({SeekRequest::get_factory_settings, Bytes(2UL * words)});
}

void wake(std::vector<SeekTransfer>& transfers) {
  transfers.push_back({SeekRequest::target_platform, {1}});
  transfers.push_back(seek_sleep());
  transfers.push_back({SeekRequest::get_firmware_info, Bytes(4)});
  transfers.push_back({SeekRequest::read_chip_id, Bytes(12)});
}

std::vector<SeekTransfer> compact_initialisation() {
  std::vector<SeekTransfer> all;
  wake(all);
  read_settings(all, 0x20, 0x0030);
  read_settings(all, 0x20, 0x0050);
  read_settings(all, 0x0C, 0x0070);
  read_settings(all, 0x06, 0x0008);
  all.push_back({SeekRequest::set_image_processing_mode, {8, 0}});
  all.push_back({SeekRequest::get_operation_mode, Bytes(2)});
  all.push_back({SeekRequest::set_image_processing_mode, {8, 0}});
  all.push_back({SeekRequest::set_operation_mode, {1, 0}});
  all.push_back({SeekRequest::get_operation_mode, Bytes(2)});
  return all;
}

std::vector<SeekTransfer> pro_initialisation() {
  constexpr std::uint16_t settings_end = 2560;
  std::vector<SeekTransfer> all;
  wake(all);
  read_settings(all, 0x06, 0x0008);
  all.push_back({SeekRequest::set_firmware_info_features, {0x17, 0}});
  all.push_back({SeekRequest::get_firmware_info, Bytes(64)});
  read_settings(all, 0x01, 0x0600);
  read_settings(all, 0x01, 0x0601);
  for (std::uint16_t address = 0; address < settings_end; address += 32) read_settings(all, 0x20, address);
  all.push_back({SeekRequest::set_firmware_info_features, {0x15, 0}});
  all.push_back({SeekRequest::get_firmware_info, Bytes(64)});
  all.push_back({SeekRequest::set_image_processing_mode, {8, 0}});
  all.push_back({SeekRequest::set_operation_mode, {1, 0}});
  return all;
}

/// Half of the median of the pixels that are not zero; 0 if all are zero.
double dead_limit(const cv::Mat1w& picture) {
  std::vector<std::uint16_t> values;
  for (const auto value : picture) {
    if (value != 0) values.push_back(value);
  }
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return 0.5 * *middle;
}

}  // namespace

const SeekGeometry& geometry(SeekModel model) {
  return model == SeekModel::compact ? compact_geometry : pro_geometry;
}

std::optional<SeekModel> seek_model(std::uint16_t vendor_id, std::uint16_t product_id) {
  if (vendor_id != seek_vendor_id) return std::nullopt;
  for (const auto model : {SeekModel::compact, SeekModel::compact_pro}) {
    if (geometry(model).product_id == product_id) return model;
  }
  return std::nullopt;
}

std::string_view to_string(SeekModel model) {
  return model == SeekModel::compact ? "Compact" : "CompactPRO";
}

std::string seek_camera_id(SeekModel model, std::string_view serial) {
  return camera_id(camera_scheme::usb, {"SEEK", to_string(model), serial});
}

bool SeekTransfer::reads() const {
  switch (request) {
    case SeekRequest::read_chip_id:
    case SeekRequest::get_operation_mode:
    case SeekRequest::get_firmware_info:
    case SeekRequest::get_factory_settings:
      return true;
    default:
      return false;
  }
}

std::vector<SeekTransfer> seek_initialisation(SeekModel model) {
  return model == SeekModel::compact ? compact_initialisation() : pro_initialisation();
}

SeekTransfer seek_sleep() {
  return {SeekRequest::set_operation_mode, {0, 0}};
}

SeekTransfer seek_frame_request(SeekModel model) {
  const auto words = static_cast<std::uint32_t>(geometry(model).frame_words());
  SeekTransfer transfer{SeekRequest::start_image_transfer, {}};
  for (unsigned shift = 0; shift < 32; shift += 8)
    transfer.data.push_back(static_cast<std::uint8_t>(words >> shift & 0xFFU));
  return transfer;
}

Result<SeekFrame> parse_seek_frame(std::span<const std::uint8_t> bytes, SeekModel model) {
  const SeekGeometry& g = geometry(model);
  if (bytes.size() != g.frame_bytes()) {
    return fail(ErrorCode::invalid_input,
                "a frame of " + std::to_string(bytes.size()) + " bytes; expected " + std::to_string(g.frame_bytes()));
  }
  SeekFrame frame;
  frame.kind = word(bytes, g.kind_word);
  frame.counter = word(bytes, g.counter_word);
  frame.temperature_word = word(bytes, g.temperature_word);
  frame.picture.create(g.picture.height, g.picture.width);
  for (int y = 0; y < g.picture.height; ++y) {
    const auto row = static_cast<std::size_t>(g.picture.y + y) * static_cast<std::size_t>(g.raw_width) +
                     static_cast<std::size_t>(g.picture.x);
    for (int x = 0; x < g.picture.width; ++x) frame.picture(y, x) = word(bytes, row + static_cast<std::size_t>(x));
  }
  return frame;
}

std::optional<std::uint16_t> seek_counter(std::span<const std::uint8_t> bytes, SeekModel model) {
  const std::size_t index = geometry(model).counter_word;
  if (bytes.size() < 2 * index + 2) return std::nullopt;
  return word(bytes, index);
}

SeekDeadPixels::SeekDeadPixels(const cv::Mat1w& calibration_picture) {
  const double limit = dead_limit(calibration_picture);
  constexpr std::uint8_t dead = 0, waiting = 1, known = 2;
  cv::Mat1b state(calibration_picture.size());
  for (int y = 0; y < state.rows; ++y) {
    for (int x = 0; x < state.cols; ++x) {
      const bool is_dead = calibration_picture(y, x) == 0 || calibration_picture(y, x) < limit;
      state(y, x) = is_dead ? dead : known;
      if (is_dead) ++dead_;
    }
  }
  const auto each_neighbour = [inside = cv::Rect({}, state.size())](cv::Point at, const auto& visit) {
    for (const cv::Point step : {cv::Point{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
      if (inside.contains(at + step)) visit(at + step);
    }
  };
  std::vector<cv::Point> ring;
  const auto put_dead_neighbours_into = [&](std::vector<cv::Point>& out, cv::Point at) {
    each_neighbour(at, [&](cv::Point neighbour) {
      if (state(neighbour) != dead) return;
      state(neighbour) = waiting;
      out.push_back(neighbour);
    });
  };
  for (int y = 0; y < state.rows; ++y) {
    for (int x = 0; x < state.cols; ++x) {
      if (state(y, x) == known) put_dead_neighbours_into(ring, {x, y});
    }
  }
  pixels_ = calibration_picture.total();
  // Each ring is found from the one outside it, so every pixel is visited once even in large defects.
  while (!ring.empty()) {
    ++depth_;
    for (const auto at : ring) {
      Filled filled{.at = at, .from = {}, .neighbours = 0};
      each_neighbour(at, [&](cv::Point from) {
        if (state(from) == known) filled.from[static_cast<std::size_t>(filled.neighbours++)] = from;
      });
      order_.push_back(filled);
    }
    for (const auto at : ring) state(at) = known;
    std::vector<cv::Point> next;
    for (const auto at : ring) put_dead_neighbours_into(next, at);
    ring = std::move(next);
  }
}

Result<void> SeekDeadPixels::check() const {
  constexpr double most_share = 0.1;
  constexpr int most_depth = 2;
  const double share = pixels_ == 0 ? 0 : static_cast<double>(dead_) / static_cast<double>(pixels_);
  if (share <= most_share && depth_ <= most_depth && (dead_ == 0 || !order_.empty())) return {};
  return fail(ErrorCode::calibration, std::to_string(dead_) + " of " + std::to_string(pixels_) +
                                          " pixels are dead in the camera's calibration frame, up to " +
                                          std::to_string(depth_) +
                                          " pixels deep in one defect. The program fills in at most 10 % of the "
                                          "pixels, and defects up to 2 pixels deep");
}

void SeekDeadPixels::fill(cv::Mat1w& picture) const {
  for (const auto& pixel : order_) {
    unsigned sum = 0;
    for (int k = 0; k < pixel.neighbours; ++k) sum += picture(pixel.from[static_cast<std::size_t>(k)]);
    picture(pixel.at) = static_cast<std::uint16_t>(sum / static_cast<unsigned>(pixel.neighbours));
  }
}

cv::Mat1w corrected_seek_picture(const cv::Mat1w& picture, const cv::Mat1w& shutter, const SeekDeadPixels& dead) {
  constexpr std::uint16_t full_scale = 0xFFFF;
  CV_Assert(picture.size() == shutter.size());
  cv::Mat1w corrected(picture.size());
  auto offset = shutter.begin();
  auto out = corrected.begin();
  for (const auto sent : picture) {
    const bool saturated = sent == 0 || sent == full_scale;
    *out++ = saturated ? sent : cv::saturate_cast<std::uint16_t>(int{sent} + seek_shutter_level - int{*offset});
    ++offset;
  }
  dead.fill(corrected);
  return corrected;
}

}  // namespace todbench
