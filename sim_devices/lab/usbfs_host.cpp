#include "sim_devices/lab/usbfs_host.h"

#include <sys/ioctl.h>
#include <umockdev.h>
// after sys/ioctl.h
#include <linux/usbdevice_fs.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <cstring>
#include <deque>
#include <list>
#include <map>
#include <mutex>
#include <thread>
#include <utility>

namespace todbench {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

/// How long a REAPURBNDELAY waits for something to reap. The client holds its lock on the node meanwhile: a submission
/// by another of its threads waits as long.
constexpr auto reap_patience = 300us;
/// No camera needs more; what a client asks for is not to be trusted.
constexpr int longest_transfer = 64 << 20;
constexpr std::size_t setup_size = 8;
constexpr std::uint32_t capabilities =
    USBDEVFS_CAP_ZERO_PACKET | USBDEVFS_CAP_NO_PACKET_SIZE_LIM | USBDEVFS_CAP_REAP_AFTER_DISCONNECT;
/// First of the devices of this bus; video cameras of the emulated system use the ports below.
constexpr int first_number = 51;
std::atomic<int> next_number{first_number};

std::string three_digits(int number) {
  std::string text = std::to_string(number);
  return std::string(3 - std::min<std::size_t>(3, text.size()), '0') + text;
}

std::string hexadecimal(std::uint8_t byte) {
  constexpr char digits[] = "0123456789abcdef";
  return {digits[byte >> 4U], digits[byte & 0xFU]};
}

std::string speed_text(UsbSpeed speed) {
  switch (speed) {
    case UsbSpeed::low:
      return "1.5";
    case UsbSpeed::full:
      return "12";
    case UsbSpeed::high:
      return "480";
    default:
      return "5000";
  }
}

std::string sys_path(int number) {
  return "/devices/pci0000:00/0000:00:14.0/usb1/1-" + std::to_string(number);
}

/// The device as sysfs shows it, in umockdev's format.
std::string description(const UsbDescriptors& d, int number) {
  const auto text = [&](std::size_t offset) {
    const std::size_t index = d.device.at(offset);
    return index >= 1 && index <= d.strings.size() ? d.strings[index - 1] : std::string();
  };
  const std::string vendor = hexadecimal(d.device.at(9)) + hexadecimal(d.device.at(8));
  const std::string product = hexadecimal(d.device.at(11)) + hexadecimal(d.device.at(10));
  std::string descriptors;
  for (const auto byte : d.device) descriptors += hexadecimal(byte);
  for (const auto byte : d.configuration) descriptors += hexadecimal(byte);
  const std::string node = "bus/usb/001/" + three_digits(number);
  return "P: " + sys_path(number) + "\nN: " + node + "\nE: DEVNAME=/dev/" + node +
         "\nE: SUBSYSTEM=usb\nE: DEVTYPE=usb_device\nE: BUSNUM=001\nE: DEVNUM=" + three_digits(number) +
         "\nE: ID_VENDOR_ID=" + vendor + "\nE: ID_MODEL_ID=" + product +
         "\nA: busnum=1\\n\nA: devnum=" + std::to_string(number) + "\\n\nA: speed=" + speed_text(d.speed) +
         "\\n\nA: bConfigurationValue=1\\n\nA: idVendor=" + vendor + "\\n\nA: idProduct=" + product +
         "\\n\nA: manufacturer=" + text(14) + "\\n\nA: product=" + text(15) + "\\n\nA: serial=" + text(16) +
         "\\n\nH: descriptors=" + descriptors + "\n\n";
}

/// A transfer between submission and reaping. What belongs to the client's memory is touched only while one of its
/// calls is being served.
struct Transfer {
  UMockdevIoctlClient* client = nullptr;
  UMockdevIoctlData* urb = nullptr;
  UMockdevIoctlData* buffer = nullptr;  ///< null for a transfer without data
  unsigned type = USBDEVFS_URB_TYPE_BULK;
  std::uint8_t endpoint = 0;
  int buffer_length = 0;
  UsbBytes sent;  ///< what the client sent; of a control transfer the setup packet first
  std::stop_source cancelled;
  // The outcome:
  int status = 0;
  UsbBytes received;
  std::size_t actual = 0;

  Transfer() = default;
  Transfer(const Transfer&) = delete;
  Transfer& operator=(const Transfer&) = delete;
  ~Transfer() {
    if (buffer != nullptr) g_object_unref(buffer);
    if (urb != nullptr) g_object_unref(urb);
  }
  [[nodiscard]] bool is_control() const { return type == USBDEVFS_URB_TYPE_CONTROL; }
  [[nodiscard]] bool is_in() const {
    return is_control() ? !sent.empty() && (sent[0] & 0x80U) != 0 : (endpoint & 0x80U) != 0;
  }
};
using TransferPtr = std::unique_ptr<Transfer>;

UsbSetup setup_of(const UsbBytes& b) {
  const auto word = [&](std::size_t k) { return static_cast<std::uint16_t>(b[k] | b[k + 1] << 8U); };
  return {.request_type = b[0], .request = b[1], .value = word(2), .index = word(4), .length = word(6)};
}

/// Memory of the client behind a pointer; null when it cannot be read. To be unreferenced.
UMockdevIoctlData* resolve(UMockdevIoctlData* data, std::size_t offset, std::size_t size) {
  GError* error = nullptr;
  UMockdevIoctlData* found = umockdev_ioctl_data_resolve(data, offset, size, &error);
  if (error == nullptr) return found;
  g_clear_error(&error);
  if (found != nullptr) g_object_unref(found);
  return nullptr;
}

}  // namespace

struct PluggedUsbDevice::State {
  std::shared_ptr<UsbDevice> device;  ///< null when it was unplugged and its port has gone
  int number = 0;

  std::mutex mutex;  ///< guards what follows
  std::condition_variable_any changed;
  bool unplugged = false;
  std::map<std::uint8_t, std::deque<TransferPtr>> waiting;  ///< by endpoint
  std::map<std::uint8_t, Transfer*> performing;
  std::deque<TransferPtr> done;
  std::map<unsigned, UMockdevIoctlClient*> claims;
  struct Reaper {
    UMockdevIoctlClient* client;
    std::optional<Clock::time_point> patience_ends;  ///< nothing: waits for ever
  };
  std::list<Reaper> reapers;  ///< calls that wait for something to reap

  std::map<std::uint8_t, std::jthread> workers;  ///< one per endpoint, control first
  std::jthread answers;                          ///< completes the calls of reapers

  ~State();
  /// After unplugging: nothing is submitted any more.
  void end_workers();
  void perform(const std::stop_token& stop, std::uint8_t endpoint);
  void answer_reapers(const std::stop_token& stop);
  [[nodiscard]] TransferPtr finished_for(UMockdevIoctlClient* client);
  [[nodiscard]] std::optional<std::pair<int, int>> serve(UMockdevIoctlClient* client);
  [[nodiscard]] int submit(UMockdevIoctlClient* client);
  [[nodiscard]] int discard(UMockdevIoctlClient* client);
  [[nodiscard]] std::pair<int, int> transfer_now(UMockdevIoctlClient* client, unsigned long request);
  [[nodiscard]] int claim(UMockdevIoctlClient* client, std::size_t size, unsigned long request);
  void cancel(UMockdevIoctlClient* client, int status);

  /// The handler owns what its signals are given.
  static UMockdevIoctlBase* handler(const std::shared_ptr<State>& state);
  static gboolean on_ioctl(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer data);
  static void on_vanished(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer data);
};

namespace {

/// Performs a transfer with the device; blocks as long as the device does.
void exchange(UsbDevice& device, Transfer& transfer) {
  if (transfer.is_control()) {
    const auto setup = setup_of(transfer.sent);
    std::span<const std::uint8_t> data(transfer.sent);
    data = setup.device_to_host() ? std::span<const std::uint8_t>() : data.subspan(setup_size);
    auto answer = usb_control(device, setup, data);
    transfer.status = answer ? 0 : -EPIPE;
    if (answer && setup.device_to_host()) transfer.received = std::move(*answer);
    transfer.actual = !answer ? 0 : setup.device_to_host() ? transfer.received.size() : data.size();
  } else if (transfer.is_in()) {
    const auto length = static_cast<std::size_t>(transfer.buffer_length);
    auto answer = device.bulk_in(transfer.endpoint, length, transfer.cancelled.get_token());
    if (answer && answer->size() > length) answer->resize(length);
    transfer.status = answer ? 0 : transfer.cancelled.stop_requested() ? -ENOENT : -EPIPE;
    if (answer) transfer.received = std::move(*answer);
    transfer.actual = transfer.received.size();
  } else {
    const bool accepted = device.bulk_out(transfer.endpoint, transfer.sent);
    transfer.status = accepted ? 0 : -EPIPE;
    transfer.actual = accepted ? transfer.sent.size() : 0;
  }
}

/// Writes the outcome into the client's memory and gives it the address of its URB.
int hand_over(UMockdevIoctlClient* client, Transfer& transfer) {
  UMockdevIoctlData* pointer = resolve(umockdev_ioctl_client_get_arg(client), 0, sizeof(void*));
  if (pointer == nullptr) return EFAULT;
  if (transfer.buffer != nullptr && !transfer.received.empty()) {
    const std::size_t offset = transfer.is_control() ? setup_size : 0;
    umockdev_ioctl_data_update(transfer.buffer, offset, transfer.received.data(),
                               static_cast<gint>(transfer.received.size()));
  }
  const auto put = [&](std::size_t offset, int value) {
    umockdev_ioctl_data_update(transfer.urb, offset, reinterpret_cast<guint8*>(&value), sizeof value);
  };
  put(offsetof(usbdevfs_urb, status), transfer.status);
  put(offsetof(usbdevfs_urb, actual_length), static_cast<int>(transfer.actual));
  umockdev_ioctl_data_set_ptr(pointer, 0, transfer.urb);
  g_object_unref(pointer);
  return 0;
}

}  // namespace

PluggedUsbDevice::State::~State() {
  end_workers();
  answers = {};
}

void PluggedUsbDevice::State::end_workers() {
  for (auto& [endpoint, worker] : workers) worker.request_stop();
  workers.clear();
  device.reset();
}

void PluggedUsbDevice::State::perform(const std::stop_token& stop, std::uint8_t endpoint) {
  std::unique_lock lock(mutex);
  while (changed.wait(lock, stop, [&] { return !waiting[endpoint].empty(); })) {
    TransferPtr transfer = std::move(waiting[endpoint].front());
    waiting[endpoint].pop_front();
    performing[endpoint] = transfer.get();
    const std::stop_callback pull(stop, [&] { transfer->cancelled.request_stop(); });
    lock.unlock();
    exchange(*device, *transfer);
    lock.lock();
    performing[endpoint] = nullptr;
    if (transfer->client == nullptr) continue;  // its program has gone
    if (unplugged) transfer->status = -ESHUTDOWN;
    done.push_back(std::move(transfer));
    changed.notify_all();
  }
}

TransferPtr PluggedUsbDevice::State::finished_for(UMockdevIoctlClient* client) {
  const auto found = std::find_if(done.begin(), done.end(), [&](const auto& t) { return t->client == client; });
  if (found == done.end()) return nullptr;
  TransferPtr transfer = std::move(*found);
  done.erase(found);
  return transfer;
}

void PluggedUsbDevice::State::answer_reapers(const std::stop_token& stop) {
  std::unique_lock lock(mutex);
  while (!stop.stop_requested()) {
    auto next = Clock::now() + 1h;
    for (auto reaper = reapers.begin(); reaper != reapers.end();) {
      UMockdevIoctlClient* client = reaper->client;
      if (const auto transfer = finished_for(client)) {
        const int error = hand_over(client, *transfer);
        umockdev_ioctl_client_complete(client, error != 0 ? -1 : 0, error);
        g_object_unref(client);
        reaper = reapers.erase(reaper);
      } else if (reaper->patience_ends && *reaper->patience_ends <= Clock::now()) {
        umockdev_ioctl_client_complete(client, -1, unplugged ? ENODEV : EAGAIN);
        g_object_unref(client);
        reaper = reapers.erase(reaper);
      } else {
        if (reaper->patience_ends) next = std::min(next, *reaper->patience_ends);
        ++reaper;
      }
    }
    changed.wait_until(lock, stop, next, [&] {
      return std::any_of(reapers.begin(), reapers.end(), [&](const Reaper& r) {
        return (r.patience_ends && *r.patience_ends < next) ||
               std::any_of(done.begin(), done.end(), [&](const auto& t) { return t->client == r.client; });
      });
    });
  }
}

int PluggedUsbDevice::State::submit(UMockdevIoctlClient* client) {
  auto transfer = std::make_unique<Transfer>();
  transfer->client = client;
  transfer->urb = resolve(umockdev_ioctl_client_get_arg(client), 0, sizeof(usbdevfs_urb));
  if (transfer->urb == nullptr) return EFAULT;
  usbdevfs_urb wanted{};
  std::memcpy(&wanted, transfer->urb->data, sizeof wanted);
  transfer->type = wanted.type;
  transfer->endpoint = wanted.endpoint;
  transfer->buffer_length = wanted.buffer_length;
  if (!transfer->is_control() && wanted.type != USBDEVFS_URB_TYPE_BULK) return EINVAL;
  if (wanted.buffer_length < 0 || wanted.buffer_length > longest_transfer) return EINVAL;
  if (wanted.buffer_length > 0) {
    transfer->buffer =
        resolve(transfer->urb, offsetof(usbdevfs_urb, buffer), static_cast<std::size_t>(wanted.buffer_length));
    if (transfer->buffer == nullptr) return EFAULT;
  }
  if (transfer->is_control() || (wanted.endpoint & 0x80U) == 0) {
    const auto* bytes = transfer->buffer != nullptr ? transfer->buffer->data : nullptr;
    transfer->sent.assign(bytes, bytes + wanted.buffer_length);
  }
  if (transfer->is_control() &&
      (transfer->sent.size() < setup_size || setup_of(transfer->sent).length + setup_size > transfer->sent.size())) {
    return EINVAL;
  }
  const std::uint8_t endpoint = transfer->is_control() ? 0 : wanted.endpoint;
  waiting[endpoint].push_back(std::move(transfer));
  if (!workers.contains(endpoint)) {
    workers[endpoint] = std::jthread([this, endpoint](const std::stop_token& stop) { perform(stop, endpoint); });
  }
  changed.notify_all();
  return 0;
}

int PluggedUsbDevice::State::discard(UMockdevIoctlClient* client) {
  gulong address = 0;
  std::memcpy(&address, umockdev_ioctl_client_get_arg(client)->data, sizeof address);
  const auto is_it = [&](const Transfer& t) { return t.client == client && t.urb->client_addr == address; };
  for (auto& [endpoint, transfer] : performing) {
    if (transfer == nullptr || !is_it(*transfer)) continue;
    transfer->cancelled.request_stop();
    return 0;
  }
  for (auto& [endpoint, queue] : waiting) {
    const auto found = std::find_if(queue.begin(), queue.end(), [&](const auto& t) { return is_it(*t); });
    if (found == queue.end()) continue;
    (*found)->status = -ENOENT;
    done.push_back(std::move(*found));
    queue.erase(found);
    changed.notify_all();
    return 0;
  }
  return EINVAL;
}

/// Ends what a program has under way: it has gone (null status given to nobody), or the cable was pulled.
void PluggedUsbDevice::State::cancel(UMockdevIoctlClient* client, int status) {
  const auto concerns = [&](const Transfer& t) { return client == nullptr || t.client == client; };
  for (auto& [endpoint, transfer] : performing) {
    if (transfer == nullptr || !concerns(*transfer)) continue;
    if (client != nullptr) transfer->client = nullptr;
    transfer->cancelled.request_stop();
  }
  for (auto& [endpoint, queue] : waiting) {
    std::deque<TransferPtr> left;
    for (auto& transfer : queue) {
      if (!concerns(*transfer)) {
        left.push_back(std::move(transfer));
      } else if (client == nullptr) {
        transfer->status = status;
        done.push_back(std::move(transfer));
      }
    }
    queue = std::move(left);
  }
  if (client != nullptr) std::erase_if(done, [&](const auto& t) { return t->client == client; });
  changed.notify_all();
}

std::pair<int, int> PluggedUsbDevice::State::transfer_now(UMockdevIoctlClient* client, unsigned long request) {
  // USBDEVFS_CONTROL and USBDEVFS_BULK block the caller; only the control endpoint is worth serving so: the device
  // answers it at once.
  if (request != USBDEVFS_CONTROL) return {-1, ENOTTY};
  UMockdevIoctlData* data = resolve(umockdev_ioctl_client_get_arg(client), 0, sizeof(usbdevfs_ctrltransfer));
  if (data == nullptr) return {-1, EFAULT};
  usbdevfs_ctrltransfer wanted{};
  std::memcpy(&wanted, data->data, sizeof wanted);
  UMockdevIoctlData* buffer =
      wanted.wLength > 0 ? resolve(data, offsetof(usbdevfs_ctrltransfer, data), wanted.wLength) : nullptr;
  const UsbSetup setup{wanted.bRequestType, wanted.bRequest, wanted.wValue, wanted.wIndex, wanted.wLength};
  std::span<const std::uint8_t> sent;
  if (buffer != nullptr && !setup.device_to_host()) sent = {buffer->data, wanted.wLength};
  auto answer = usb_control(*device, setup, sent);
  if (answer && buffer != nullptr && setup.device_to_host() && !answer->empty()) {
    umockdev_ioctl_data_update(buffer, 0, answer->data(), static_cast<gint>(answer->size()));
  }
  const int size = !answer ? -1 : setup.device_to_host() ? static_cast<int>(answer->size()) : int{wanted.wLength};
  if (buffer != nullptr) g_object_unref(buffer);
  g_object_unref(data);
  return {size, answer ? 0 : EPIPE};
}

int PluggedUsbDevice::State::claim(UMockdevIoctlClient* client, std::size_t size, unsigned long request) {
  UMockdevIoctlData* data = resolve(umockdev_ioctl_client_get_arg(client), 0, size);
  if (data == nullptr) return EFAULT;
  unsigned interface = 0;  // the first member of all that name an interface
  std::memcpy(&interface, data->data, sizeof interface);
  g_object_unref(data);
  const auto owner = claims.find(interface);
  if (request == USBDEVFS_RELEASEINTERFACE) {
    if (owner == claims.end() || owner->second != client) return EINVAL;
    claims.erase(owner);
    return 0;
  }
  if (owner != claims.end() && owner->second != client) return EBUSY;
  claims[interface] = client;
  return 0;
}

/// Result and errno of a call; nothing when it is answered later.
std::optional<std::pair<int, int>> PluggedUsbDevice::State::serve(UMockdevIoctlClient* client) {
  const auto result = [](int error) { return std::pair(error != 0 ? -1 : 0, error); };
  const unsigned long request = umockdev_ioctl_client_get_request(client) & 0xFFFFFFFFU;
  if (request == USBDEVFS_REAPURB || request == USBDEVFS_REAPURBNDELAY) {
    // What ended before the cable was pulled can still be reaped.
    const bool blocks = request == USBDEVFS_REAPURB && !unplugged;
    g_object_ref(client);  // nobody else holds it until it is answered
    reapers.push_back({client, blocks ? std::nullopt : std::optional<Clock::time_point>(Clock::now() + reap_patience)});
    changed.notify_all();
    return std::nullopt;
  }
  if (unplugged) return result(ENODEV);
  switch (request) {
    case USBDEVFS_SUBMITURB:
      return result(submit(client));
    case USBDEVFS_DISCARDURB:
      return result(discard(client));
    case USBDEVFS_CONTROL:
    case USBDEVFS_BULK:
      return transfer_now(client, request);
    case USBDEVFS_CLAIMINTERFACE:
    case USBDEVFS_RELEASEINTERFACE:
      return result(claim(client, sizeof(unsigned), request));
    case USBDEVFS_DISCONNECT_CLAIM:
      return result(claim(client, sizeof(usbdevfs_disconnect_claim), request));
    case USBDEVFS_GET_CAPABILITIES: {
      UMockdevIoctlData* data = resolve(umockdev_ioctl_client_get_arg(client), 0, sizeof capabilities);
      if (data == nullptr) return result(EFAULT);
      std::uint32_t value = capabilities;
      umockdev_ioctl_data_update(data, 0, reinterpret_cast<guint8*>(&value), sizeof value);
      g_object_unref(data);
      return result(0);
    }
    case USBDEVFS_GETDRIVER:
      return result(ENODATA);
    case USBDEVFS_IOCTL:  // (dis)connecting a driver: there is none
      return result(ENODATA);
    case USBDEVFS_GET_SPEED:
      return std::pair(static_cast<int>(device->descriptors().speed), 0);
    case USBDEVFS_CLEAR_HALT:
    case USBDEVFS_RESETEP:
    case USBDEVFS_RESET:
    case USBDEVFS_SETCONFIGURATION:
    case USBDEVFS_SETINTERFACE:
      return result(0);
    default:
      return result(ENOTTY);
  }
}

gboolean PluggedUsbDevice::State::on_ioctl(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer data) {
  auto& state = *static_cast<std::shared_ptr<State>*>(data);
  const std::lock_guard lock(state->mutex);
  const auto answer = state->serve(client);
  if (answer) umockdev_ioctl_client_complete(client, answer->first, answer->second);
  return TRUE;
}

void PluggedUsbDevice::State::on_vanished(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer data) {
  auto& state = *static_cast<std::shared_ptr<State>*>(data);
  const std::lock_guard lock(state->mutex);
  state->cancel(client, -ENOENT);
  state->reapers.remove_if([&](const Reaper& r) {
    if (r.client != client) return false;
    g_object_unref(client);
    return true;
  });
  std::erase_if(state->claims, [&](const auto& claim) { return claim.second == client; });
}

UMockdevIoctlBase* PluggedUsbDevice::State::handler(const std::shared_ptr<State>& state) {
  UMockdevIoctlBase* made = umockdev_ioctl_base_new();
  const auto connect = [&](const char* signal, GCallback callback) {
    const GClosureNotify forget = [](gpointer data, GClosure*) {
      const std::unique_ptr<std::shared_ptr<State>> ended(static_cast<std::shared_ptr<State>*>(data));
    };
    auto given = std::make_unique<std::shared_ptr<State>>(state);
    g_signal_connect_data(made, signal, callback, given.release(), forget, static_cast<GConnectFlags>(0));
  };
  connect("handle-ioctl", G_CALLBACK(&State::on_ioctl));
  connect("client-vanished", G_CALLBACK(&State::on_vanished));
  return made;
}

PluggedUsbDevice::PluggedUsbDevice(std::shared_ptr<MockSystem> system, std::shared_ptr<State> state)
    : system_(std::move(system)), state_(std::move(state)) {}

PluggedUsbDevice::~PluggedUsbDevice() {
  unplug();
  state_->end_workers();
}

Result<std::unique_ptr<PluggedUsbDevice>> PluggedUsbDevice::plug(std::shared_ptr<MockSystem> system,
                                                                 std::shared_ptr<UsbDevice> device) {
  if (device->descriptors().device.size() != 18) {
    return fail(ErrorCode::internal, "emulated USB device: no device descriptor");
  }
  auto state = std::make_shared<State>();
  state->number = next_number++;
  const std::string sysfs = description(device->descriptors(), state->number);
  state->device = std::move(device);
  const std::string node = "/dev/bus/usb/001/" + three_digits(state->number);
  // Attached first: a hot-plug listener opens the node as soon as it is announced.
  UMockdevIoctlBase* handler = State::handler(state);
  GError* error = nullptr;
  const bool attached = umockdev_testbed_attach_ioctl(system->testbed(), node.c_str(), handler, &error) != 0;
  g_object_unref(handler);  // the emulated system has it
  if (!attached) {
    const std::string message = error != nullptr ? error->message : "unknown error";
    g_clear_error(&error);
    return fail(ErrorCode::internal, "emulated USB device: " + message);
  }
  state->answers = std::jthread([raw = state.get()](const std::stop_token& stop) { raw->answer_reapers(stop); });
  if (auto added = system->add(sysfs); !added) return tl::unexpected(added.error());
  return std::unique_ptr<PluggedUsbDevice>(new PluggedUsbDevice(std::move(system), std::move(state)));
}

std::string PluggedUsbDevice::node() const {
  return "/dev/bus/usb/001/" + three_digits(state_->number);
}

void PluggedUsbDevice::unplug() {
  {
    const std::lock_guard lock(state_->mutex);
    if (state_->unplugged) return;
    state_->unplugged = true;
    state_->cancel(nullptr, -ESHUTDOWN);
    // A call that waits for ever is answered now.
    for (auto& reaper : state_->reapers) {
      if (!reaper.patience_ends) reaper.patience_ends = Clock::now() + reap_patience;
    }
  }
  state_->changed.notify_all();
  const std::string path = "/sys" + sys_path(state_->number);
  system_->announce(path, "remove");
  system_->remove(path);
}

}  // namespace todbench
