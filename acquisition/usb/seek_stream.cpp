// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/usb/seek_stream.h"

#include <sys/time.h>

#include <algorithm>
#include <utility>

#include "acquisition/base/host_clock.h"

namespace todbench {
namespace {

constexpr unsigned request_timeout_ms = 1000;
/// A camera sends 7 ... 15 frames a second; its shutter takes about half a second.
constexpr unsigned read_timeout_ms = 1500;
/// Failures in succession, timeouts excluded, after which the camera is lost.
constexpr int most_failures = 5;

}  // namespace

SeekStream::SeekStream(UsbContext context, UsbConnection& connection, SeekModel model, std::size_t waiting)
    : context_(std::move(context)),
      connection_(connection),
      model_(model),
      frame_bytes_(geometry(model).frame_bytes()),
      most_waiting_(waiting),
      frame_(frame_bytes_),
      requesting_(libusb_alloc_transfer(0)),
      reading_(libusb_alloc_transfer(0)) {
  const SeekTransfer wanted = seek_frame_request(model);
  request_.resize(LIBUSB_CONTROL_SETUP_SIZE);
  libusb_fill_control_setup(
      request_.data(),
      LIBUSB_ENDPOINT_OUT | static_cast<unsigned>(LIBUSB_REQUEST_TYPE_VENDOR) | LIBUSB_RECIPIENT_INTERFACE,
      static_cast<std::uint8_t>(wanted.request), 0, 0, static_cast<std::uint16_t>(wanted.data.size()));
  request_.insert(request_.end(), wanted.data.begin(), wanted.data.end());
}

Result<std::unique_ptr<SeekStream>> SeekStream::start(UsbContext context, UsbConnection& connection, SeekModel model,
                                                      std::size_t waiting) {
  auto stream = std::unique_ptr<SeekStream>(new SeekStream(context, connection, model, waiting));
  // Removal also ends the transfers; between two transfers only this callback detects it.
  libusb_device_descriptor descriptor{};
  libusb_get_device_descriptor(libusb_get_device(connection.handle()), &descriptor);
  libusb_hotplug_register_callback(context.get(), LIBUSB_HOTPLUG_EVENT_DEVICE_LEFT, 0, descriptor.idVendor,
                                   descriptor.idProduct, LIBUSB_HOTPLUG_MATCH_ANY, &SeekStream::on_left, stream.get(),
                                   &stream->hotplug_);
  stream->submit(Step::requesting);
  if (stream->lost_) return fail(ErrorCode::disconnected, "the camera is no longer connected");
  stream->events_ = std::thread([raw = stream.get()] { raw->serve_events(); });
  return stream;
}

SeekStream::~SeekStream() {
  end();
}

void SeekStream::end() {
  {
    const std::lock_guard lock(mutex_);
    if (std::exchange(ending_, true)) return;
    if (under_way_) libusb_cancel_transfer(submitted_);
    changed_.notify_all();
  }
  libusb_hotplug_deregister_callback(context_.get(), hotplug_);
  libusb_interrupt_event_handler(context_.get());
  if (events_.joinable()) events_.join();
}

void SeekStream::serve_events() {
  for (;;) {
    {
      const std::lock_guard lock(mutex_);
      if (ending_ && !under_way_) return;
    }
    timeval wait{.tv_sec = 0, .tv_usec = 200'000};
    libusb_handle_events_timeout_completed(context_.get(), &wait, nullptr);
  }
}

/// Called before the event thread exists, and later on it.
void SeekStream::submit(Step step) {
  libusb_transfer* transfer = step == Step::requesting ? requesting_.get() : reading_.get();
  if (step == Step::requesting) {
    libusb_fill_control_transfer(transfer, connection_.handle(), request_.data(), &SeekStream::called_back, this,
                                 request_timeout_ms);
    received_ = 0;
  } else {
    libusb_fill_bulk_transfer(transfer, connection_.handle(), seek_bulk_in_endpoint, frame_.data() + received_,
                              static_cast<int>(frame_bytes_ - received_), &SeekStream::called_back, this,
                              read_timeout_ms);
  }
  const std::lock_guard lock(mutex_);
  under_way_ = false;
  if (ending_ || lost_) return;
  if (libusb_submit_transfer(transfer) != 0) {
    lost_ = true;
    changed_.notify_all();
    return;
  }
  submitted_ = transfer;
  under_way_ = true;
}

void SeekStream::called_back(libusb_transfer* transfer) {
  auto* stream = static_cast<SeekStream*>(transfer->user_data);
  if (transfer->status == LIBUSB_TRANSFER_NO_DEVICE) {
    stream->lose();
  } else if (transfer == stream->requesting_.get()) {
    stream->on_requested(*transfer);
  } else {
    stream->on_read(*transfer);
  }
}

void SeekStream::on_requested(const libusb_transfer& transfer) {
  if (transfer.status == LIBUSB_TRANSFER_COMPLETED) {
    submit(Step::reading);
  } else {
    retry(transfer.status);
  }
}

void SeekStream::on_read(const libusb_transfer& transfer) {
  received_ += static_cast<std::size_t>(std::max(transfer.actual_length, 0));
  const bool more_may_come = transfer.status == LIBUSB_TRANSFER_COMPLETED && transfer.actual_length > 0;
  if (received_ < frame_bytes_ && more_may_come) return submit(Step::reading);
  if (received_ == 0 || transfer.status == LIBUSB_TRANSFER_CANCELLED) return retry(transfer.status);
  failures_ = 0;
  deliver();
  submit(Step::requesting);
}

void SeekStream::deliver() {
  SeekArrival arrival;
  arrival.bytes.assign(frame_.begin(), frame_.begin() + static_cast<std::ptrdiff_t>(received_));
  arrival.host_time_ns = monotonic_ns();
  const std::lock_guard lock(mutex_);
  if (arrivals_.size() >= most_waiting_) {
    // A slow reader loses the newest frames except the shutter's, on which later frames depend.
    const auto parsed = parse_seek_frame(arrival.bytes, model_);
    overflowed_ = true;
    if (!parsed || !parsed->is(SeekFrameKind::shutter)) return;
    arrivals_.pop_back();
  }
  arrival.after_unread = std::exchange(overflowed_, false);
  arrivals_.push_back(std::move(arrival));
  changed_.notify_all();
}

void SeekStream::retry(int status) {
  // A camera that is busy with its shutter may let a request time out; all other failures are counted.
  failures_ = status == LIBUSB_TRANSFER_TIMED_OUT || status == LIBUSB_TRANSFER_CANCELLED ? 0 : failures_ + 1;
  if (failures_ >= most_failures) return lose();
  submit(Step::requesting);
}

void SeekStream::lose() {
  const std::lock_guard lock(mutex_);
  under_way_ = false;
  lost_ = true;
  changed_.notify_all();
}

int SeekStream::on_left(libusb_context*, libusb_device* device, libusb_hotplug_event, void* stream) {
  auto* self = static_cast<SeekStream*>(stream);
  if (device != libusb_get_device(self->connection_.handle())) return 0;
  const std::lock_guard lock(self->mutex_);
  self->lost_ = true;
  self->changed_.notify_all();
  return 0;
}

Result<SeekArrival> SeekStream::next(std::chrono::milliseconds timeout) {
  std::unique_lock lock(mutex_);
  const bool something = changed_.wait_for(lock, timeout, [this] { return ending_ || lost_ || !arrivals_.empty(); });
  if (ending_) return fail(ErrorCode::interrupted, "stopped");
  if (!arrivals_.empty()) {
    SeekArrival arrival = std::move(arrivals_.front());
    arrivals_.pop_front();
    return arrival;
  }
  if (lost_) return fail(ErrorCode::disconnected, "the camera is no longer connected");
  return fail(something ? ErrorCode::internal : ErrorCode::timeout,
              "no frame within " + std::to_string(timeout.count()) + " ms");
}

}  // namespace todbench
