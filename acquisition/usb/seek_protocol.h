// SPDX-License-Identifier: GPL-3.0-or-later
// Protocol of Seek Thermal cameras over USB: pure functions from bytes to pictures, no device. Source: the
// libseek-thermal project (OpenThermal); Seek publishes no documentation.
#pragma once

#include <array>
#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/base/result.h"

namespace todbench {

inline constexpr std::uint16_t seek_vendor_id = 0x289D;
inline constexpr std::uint8_t seek_bulk_in_endpoint = 0x81;

/// Models of the family.
enum class SeekModel {
  compact,      ///< 289d:0010, picture 207 x 154
  compact_pro,  ///< 289d:0011, picture 320 x 240
};

/// Layout of a frame, which consists of 16-bit little-endian words. The first row of every frame is a header, and the
/// picture does not fill the remaining rows.
struct SeekGeometry {
  std::uint16_t product_id;
  int raw_width, raw_height;  ///< words
  cv::Rect picture;           ///< area of the picture in the raw frame
  std::size_t kind_word, counter_word, temperature_word;

  [[nodiscard]] std::size_t frame_words() const {
    return static_cast<std::size_t>(raw_width) * static_cast<std::size_t>(raw_height);
  }
  [[nodiscard]] std::size_t frame_bytes() const { return 2 * frame_words(); }
};
/// Returns the layout of a model.
[[nodiscard]] const SeekGeometry& geometry(SeekModel model);
[[nodiscard]] std::optional<SeekModel> seek_model(std::uint16_t vendor_id, std::uint16_t product_id);
/// Returns "Compact" or "CompactPRO".
[[nodiscard]] std::string_view to_string(SeekModel model);

/// Returns "usb:SEEK-MODEL-SERIAL".
[[nodiscard]] std::string seek_camera_id(SeekModel model, std::string_view serial);

/// Vendor requests to the interface (bmRequestType 0x41 out, 0xC1 in), wValue and wIndex 0.
enum class SeekRequest : std::uint8_t {
  read_chip_id = 0x36,
  set_operation_mode = 0x3C,
  get_operation_mode = 0x3D,
  set_image_processing_mode = 0x3E,
  get_firmware_info = 0x4E,
  start_image_transfer = 0x53,  ///< four bytes: the number of words
  target_platform = 0x54,
  set_firmware_info_features = 0x55,
  set_factory_settings_features = 0x56,
  get_factory_settings = 0x58,
};

/// One control transfer. `data` contains the bytes to send; in a reading request only its size is used.
struct SeekTransfer {
  SeekRequest request;
  std::vector<std::uint8_t> data;
  [[nodiscard]] bool reads() const;
};
/// Returns the transfers required before the first frame, in order.
[[nodiscard]] std::vector<SeekTransfer> seek_initialisation(SeekModel model);
/// Returns the transfer that puts the camera to sleep. Send it three times, as the software of the manufacturer does.
[[nodiscard]] SeekTransfer seek_sleep();
/// Returns the transfer that requests one frame.
[[nodiscard]] SeekTransfer seek_frame_request(SeekModel model);

/// Content of a frame, by its number in the protocol. All other numbers are used for calibration.
enum class SeekFrameKind : std::uint16_t {
  shutter = 1,      ///< the closed shutter: shows the offsets of the pixels
  image = 3,        ///< the scene
  calibration = 4,  ///< the first frame after initialisation: dead pixels are zero
};

/// A frame as received.
struct SeekFrame {
  std::uint16_t kind = 0;     ///< a SeekFrameKind, or an unknown number
  std::uint16_t counter = 0;  ///< number of exposures, wraps at 2^16
  std::uint16_t temperature_word = 0;
  cv::Mat1w picture;  ///< as sent, without correction of shutter offsets and dead pixels
  [[nodiscard]] bool is(SeekFrameKind k) const { return kind == static_cast<std::uint16_t>(k); }
};
/// Reads a frame. Error: `invalid_input` if the bytes are not exactly one frame.
[[nodiscard]] Result<SeekFrame> parse_seek_frame(std::span<const std::uint8_t> bytes, SeekModel model);
/// Returns the counter of a truncated frame; empty if the bytes end before the counter.
[[nodiscard]] std::optional<std::uint16_t> seek_counter(std::span<const std::uint8_t> bytes, SeekModel model);

/// Pixels without a signal, and the neighbours that replace each of them. A pixel is dead if it is zero in the
/// calibration frame, or below half the median of the pixels that are not zero. A dead pixel gets the mean, rounded
/// down, of its four neighbours, without neighbours that are dead and not yet filled. Larger defects are filled from
/// the rim inwards, each ring from the ring around it. The result therefore does not depend on the order within a ring.
class SeekDeadPixels {
 public:
  SeekDeadPixels() = default;  ///< none
  explicit SeekDeadPixels(const cv::Mat1w& calibration_picture);
  [[nodiscard]] std::size_t count() const { return dead_; }
  /// Returns the depth of the deepest pixel inside a defect, in pixels; 1 for a dead pixel with a live neighbour.
  [[nodiscard]] int depth() const { return depth_; }
  /// Checks the number of replaced pixels. Error: `calibration` if too many pixels are replaced. The limits are 10 % of
  /// the pixels and a defect depth of 2 pixels; a deeper defect hides a target of 4 pixels. By design a Compact omits
  /// every fifteenth pixel (6.7 %); 0.3 to 1 % of the pixels are dead.
  [[nodiscard]] Result<void> check() const;
  /// Fills the dead pixels. Precondition: same geometry as the calibration picture, or no dead pixels.
  void fill(cv::Mat1w& picture) const;

 private:
  struct Filled {
    cv::Point at;
    std::array<cv::Point, 4> from;
    int neighbours;
  };
  std::vector<Filled> order_;
  std::size_t dead_ = 0, pixels_ = 0;
  int depth_ = 0;
};

/// Count that a pixel has at the temperature of the shutter.
inline constexpr int seek_shutter_level = 0x4000;

/// Returns picture - shutter picture + seek_shutter_level, clipped to 16 bits, with dead pixels filled. A pixel that
/// was sent as 0 or 65535 keeps its value for the integrity gate.
[[nodiscard]] cv::Mat1w corrected_seek_picture(const cv::Mat1w& picture, const cv::Mat1w& shutter,
                                               const SeekDeadPixels& dead);

}  // namespace todbench
