// SPDX-License-Identifier: GPL-3.0-or-later
// Stream of frames of an opened Seek camera. Uses asynchronous transfers and requests one frame at a time, as the
// camera requires. Private to the USB back end.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "acquisition/base/result.h"
#include "acquisition/usb/usb_connection.h"

namespace todbench {

/// Bytes received for one request.
struct SeekArrival {
  std::vector<std::uint8_t> bytes;  ///< fewer than a frame if the transfer ended early
  std::int64_t host_time_ns = 0;    ///< CLOCK_MONOTONIC at the end of the transfer
  bool after_unread = false;        ///< frames directly before this one were dropped because the reader was slow
};

/// Requests and receives frames on a separate thread, from creation to end().
class SeekStream {
 public:
  /// Starts a stream. `connection` must outlive it. `waiting`: maximum number of frames kept for a slow reader. Further
  /// frames are dropped, and the camera's counter shows the gap. Errors: `disconnected`.
  [[nodiscard]] static Result<std::unique_ptr<SeekStream>> start(UsbContext context, UsbConnection& connection,
                                                                 SeekModel model, std::size_t waiting);
  ~SeekStream();
  SeekStream(const SeekStream&) = delete;
  SeekStream& operator=(const SeekStream&) = delete;

  /// Returns the next arrival. Errors: `timeout`, `interrupted` (end() was called), `disconnected`. Any thread.
  [[nodiscard]] Result<SeekArrival> next(std::chrono::milliseconds timeout);
  /// Ends the stream and all present and later calls of next() within milliseconds. Any thread, one at a time.
  void end();

 private:
  struct FreeTransfer {
    void operator()(libusb_transfer* transfer) const { libusb_free_transfer(transfer); }
  };
  using TransferPtr = std::unique_ptr<libusb_transfer, FreeTransfer>;
  enum class Step { requesting, reading };

  SeekStream(UsbContext context, UsbConnection& connection, SeekModel model, std::size_t waiting);
  void serve_events();
  void submit(Step step);
  void on_requested(const libusb_transfer& transfer);
  void on_read(const libusb_transfer& transfer);
  void deliver();
  void retry(int status);
  void lose();
  static void LIBUSB_CALL called_back(libusb_transfer* transfer);
  static int LIBUSB_CALL on_left(libusb_context*, libusb_device*, libusb_hotplug_event, void* stream);

  UsbContext context_;
  UsbConnection& connection_;
  SeekModel model_;
  std::size_t frame_bytes_;
  std::size_t most_waiting_;
  std::vector<std::uint8_t> request_, frame_;  ///< buffers of the transfers
  std::size_t received_ = 0;                   ///< bytes of the present frame received so far
  int failures_ = 0;                           ///< successive failures
  TransferPtr requesting_, reading_;
  libusb_hotplug_callback_handle hotplug_{};

  std::mutex mutex_;  ///< guards the following members
  std::condition_variable changed_;
  std::deque<SeekArrival> arrivals_;
  bool overflowed_ = false;  ///< since the last arrival
  bool under_way_ = false;   ///< a transfer has been submitted and its callback has not run
  bool ending_ = false, lost_ = false;
  libusb_transfer* submitted_ = nullptr;

  std::thread events_;
};

}  // namespace todbench
