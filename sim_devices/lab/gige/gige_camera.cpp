#include "sim_devices/lab/gige/gige_camera.h"

#include <arv.h>
#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <bit>
#include <cmath>
#include <condition_variable>
#include <cstring>
#include <mutex>
#include <string_view>
#include <thread>
#include <vector>

#include "acquisition/aravis/gvcp_client.h"

namespace todbench {

/// Generated from gige_camera.xml.
std::string_view gige_camera_xml();

namespace {

using namespace std::chrono_literals;

/// This camera's own registers; gige_camera.xml names the same addresses.
constexpr std::uint32_t register_ir_format = 0xA000;
constexpr std::uint32_t register_nuc_mode = 0xA004;
constexpr std::uint32_t register_nuc_action = 0xA008;
constexpr std::uint32_t register_noise_reduction = 0xA00C;
constexpr std::uint32_t register_device_temperature = 0xA010;
constexpr std::uint32_t register_nuc_interval = 0xA014;
constexpr std::uint32_t register_largest_count = 0xA01C;
constexpr std::uint32_t register_big_endian = 0xA020;
constexpr std::uint32_t register_instance = 0xA024;
constexpr std::uint32_t register_linear_scale = 0xA040;
constexpr std::uint32_t register_linear_offset = 0xA048;
constexpr std::uint32_t register_planck = 0xA050;  ///< R, B, F, O, eight bytes each

constexpr std::uint32_t ir_format_radiometric = 0;
constexpr std::uint32_t ir_format_100mk = 1;
constexpr std::uint32_t ir_format_10mk = 2;
constexpr std::uint32_t nuc_mode_automatic = 1;

/// GigE Vision bootstrap strings.
constexpr std::uint32_t bootstrap_vendor = 0x48;
constexpr std::uint32_t bootstrap_model = 0x68;
constexpr std::uint32_t bootstrap_version = 0x88;
constexpr std::uint32_t bootstrap_serial = 0xD8;

constexpr ArvPixelFormat mono14 = 0x01100025;
constexpr ArvPixelFormat mono16 = 0x01100007;

/// Commands are noticed this often while no frame is being exposed.
constexpr auto command_poll_period = 20ms;

/// A file that exists only in memory, for a library that wants a path.
class MemoryFile {
 public:
  explicit MemoryFile(std::string_view content) : fd_(memfd_create("genicam", MFD_CLOEXEC)) {
    std::size_t written = 0;
    while (fd_ >= 0 && written < content.size()) {
      const auto size = ::write(fd_, content.data() + written, content.size() - written);
      if (size <= 0) break;
      written += static_cast<std::size_t>(size);
    }
  }
  ~MemoryFile() {
    if (fd_ >= 0) ::close(fd_);
  }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  [[nodiscard]] std::string path() const { return "/proc/self/fd/" + std::to_string(fd_); }

 private:
  int fd_;
};

struct Unref {
  void operator()(void* object) const { g_object_unref(object); }
};

Result<void> validate(const EmulatedGigeCameraConfig& config) {
  const auto bad = [](const std::string& what) { return fail(ErrorCode::invalid_input, "emulated camera: " + what); };
  if (config.width < 1 || config.height < 1 || config.width > 4096 || config.height > 4096) {
    return bad("width and height must be 1 ... 4096");
  }
  if (config.significant_bits < 8 || config.significant_bits > 16) return bad("significant_bits must be 8 ... 16");
  if (!(config.frame_rate_hz >= 0.1 && config.frame_rate_hz <= 1000)) return bad("frame_rate_hz must be 0.1 ... 1000");
  if (!(config.kelvin_per_count > 0) || !std::isfinite(config.offset_k))
    return bad("kelvin_per_count must be positive");
  if (config.serial.empty() || config.serial.size() > 15) return bad("serial must have 1 ... 15 characters");
  if (config.vendor.size() > 31 || config.model.size() > 31 || config.firmware.size() > 31) {
    return bad("vendor, model and firmware must have at most 31 characters");
  }
  if (config.first_frame_id == 0) return bad("frame id 0 does not exist");
  if (config.nuc_freeze_frames < 0) return bad("nuc_freeze_frames must not be negative");
  return {};
}

/// Counts of IRFormat=Radiometric for every count of the linear scale; 0 where the formula does not reach.
std::vector<std::uint16_t> radiometric_table(const EmulatedGigeCameraConfig& config) {
  std::vector<std::uint16_t> table(65536);
  const auto scale = RadiometricScale::planck(config.radiometric);
  if (!scale) return table;
  for (std::size_t count = 0; count < table.size(); ++count) {
    const auto signal = scale->counts(config.offset_k + config.kelvin_per_count * static_cast<double>(count));
    table[count] = cv::saturate_cast<std::uint16_t>(signal.value_or(0));
  }
  return table;
}

}  // namespace

struct EmulatedGigeCamera::State {
  EmulatedGigeCameraConfig config;
  Exposure exposure;
  NucObserver on_nuc;
  std::vector<std::uint16_t> radiometric;

  mutable std::mutex mutex;  ///< guards what follows, down to `polled`
  std::uint64_t exposures = 0;
  std::uint64_t failed_exposures = 0;
  std::uint64_t corrections = 0;
  std::uint64_t clock_ns = 0;
  unsigned exposures_to_lose = 0;
  unsigned frozen_frames = 0;
  std::uint16_t next_frame_id = 1;
  cv::Mat1w last_sent;
  std::condition_variable_any polled;

  std::unique_ptr<ArvFakeCamera, Unref> registers;  ///< outlives the camera's thread, which reads it until the end
  std::unique_ptr<ArvGvFakeCamera, Unref> camera;
  std::jthread poll;  ///< last member: stops before anything that it uses goes

  ~State() {
    poll = {};
    camera.reset();  // joins the camera's thread, which uses this state
  }

  [[nodiscard]] std::uint32_t read(std::uint32_t address) const {
    guint32 value = 0;
    arv_fake_camera_read_register(registers.get(), address, &value);
    return value;
  }
  void write(std::uint32_t address, std::uint32_t value) const {
    arv_fake_camera_write_register(registers.get(), address, value);
  }
  void write(std::uint32_t address, double value) const {
    const std::uint64_t big_endian = GUINT64_TO_BE(std::bit_cast<std::uint64_t>(value));
    arv_fake_camera_write_memory(registers.get(), address, sizeof big_endian, &big_endian);
  }
  void write(std::uint32_t address, const std::string& text, std::size_t size) const {
    std::vector<char> field(size, '\0');
    std::memcpy(field.data(), text.data(), std::min(text.size(), size - 1));
    arv_fake_camera_write_memory(registers.get(), address, static_cast<guint32>(size), field.data());
  }

  void power_up();
  void serve_commands();
  void begin_correction();
  [[nodiscard]] cv::Mat1w expose();
  [[nodiscard]] cv::Mat1w processed(const cv::Mat1w& counts, ArvPixelFormat format);
  void fill(ArvBuffer* buffer, ArvPixelFormat format);
  static void on_fill(ArvBuffer* buffer, void* state, guint32, guint32, ArvPixelFormat format) {
    static_cast<State*>(state)->fill(buffer, format);
  }
};

void EmulatedGigeCamera::State::power_up() {
  const auto format = config.significant_bits <= 14 ? mono14 : mono16;
  write(bootstrap_vendor, config.vendor, 32);
  write(bootstrap_model, config.model, 32);
  write(bootstrap_version, config.firmware, 32);
  write(bootstrap_serial, config.serial, 16);
  write(ARV_FAKE_CAMERA_REGISTER_SENSOR_WIDTH, static_cast<std::uint32_t>(config.width));
  write(ARV_FAKE_CAMERA_REGISTER_SENSOR_HEIGHT, static_cast<std::uint32_t>(config.height));
  write(ARV_FAKE_CAMERA_REGISTER_WIDTH, static_cast<std::uint32_t>(config.width));
  write(ARV_FAKE_CAMERA_REGISTER_HEIGHT, static_cast<std::uint32_t>(config.height));
  write(ARV_FAKE_CAMERA_REGISTER_PIXEL_FORMAT, static_cast<std::uint32_t>(format));
  write(ARV_FAKE_CAMERA_REGISTER_ACQUISITION_FRAME_PERIOD_US,
        static_cast<std::uint32_t>(std::lround(1e6 / config.frame_rate_hz)));
  write(register_ir_format, ir_format_10mk);
  write(register_noise_reduction, std::uint32_t{1});
  write(register_nuc_interval, std::uint32_t{9000});
  write(register_device_temperature, static_cast<std::uint32_t>(std::lround(100 * config.device_temperature_c)));
  write(register_largest_count, (std::uint32_t{1} << config.significant_bits) - 1);
  write(register_linear_scale, config.kelvin_per_count);
  write(register_linear_offset, config.offset_k);
  const PlanckScale& planck = config.radiometric;
  write(register_planck, planck.r);
  write(register_planck + 8, planck.b);
  write(register_planck + 16, planck.f);
  write(register_planck + 24, planck.o);
  next_frame_id = config.first_frame_id;
  radiometric = radiometric_table(config);
  arv_fake_camera_set_fill_pattern(registers.get(), &State::on_fill, this);
}

void EmulatedGigeCamera::State::begin_correction() {
  {
    const std::lock_guard lock(mutex);
    ++corrections;
    frozen_frames = static_cast<unsigned>(config.nuc_freeze_frames);
  }
  if (on_nuc) on_nuc();
}

void EmulatedGigeCamera::State::serve_commands() {
  bool commanded = false;
  {
    const std::lock_guard lock(mutex);
    commanded = read(register_nuc_action) != 0;
    if (commanded) write(register_nuc_action, std::uint32_t{0});
  }
  if (commanded) begin_correction();
}

cv::Mat1w EmulatedGigeCamera::State::expose() {
  serve_commands();
  std::uint64_t index = 0;
  bool frozen = false;
  {
    const std::lock_guard lock(mutex);
    index = exposures++;
    clock_ns += std::uint64_t{1000} * read(ARV_FAKE_CAMERA_REGISTER_ACQUISITION_FRAME_PERIOD_US);
  }
  if (read(register_nuc_mode) == nuc_mode_automatic && index > 0 &&
      index % std::max<std::uint32_t>(1, read(register_nuc_interval)) == 0) {
    begin_correction();
  }
  {
    const std::lock_guard lock(mutex);
    frozen = frozen_frames > 0 && !last_sent.empty();
    if (frozen_frames > 0) --frozen_frames;
  }
  if (frozen) return {};
  cv::Mat1w counts;
  try {
    counts = exposure(index);
  } catch (...) {
    // Nothing may propagate into the C library that called; the owner sees the count.
    counts = {};
  }
  if (counts.cols == config.width && counts.rows == config.height) return counts;
  const std::lock_guard lock(mutex);
  ++failed_exposures;
  return cv::Mat1w::zeros(config.height, config.width);
}

cv::Mat1w EmulatedGigeCamera::State::processed(const cv::Mat1w& counts, ArvPixelFormat format) {
  cv::Mat1w sent = counts.clone();
  const auto ir_format = read(register_ir_format);
  if (ir_format == ir_format_radiometric) {
    for (auto& count : sent) count = radiometric[count];
  } else if (ir_format == ir_format_100mk) {
    for (auto& count : sent) count = static_cast<std::uint16_t>((count + 5) / 10);
  }
  const auto largest = static_cast<std::uint16_t>(
      (std::uint32_t{1} << (format == mono14 ? std::min(14, config.significant_bits) : config.significant_bits)) - 1);
  for (auto& count : sent) count = std::min(count, largest);
  if (read(register_noise_reduction) != 0 && last_sent.size() == sent.size()) {
    auto previous = last_sent.begin();
    for (auto& count : sent) count = static_cast<std::uint16_t>((count + *previous++ + 1) / 2);
  }
  return sent;
}

void EmulatedGigeCamera::State::fill(ArvBuffer* buffer, ArvPixelFormat format) {
  unsigned lost = 0;
  {
    const std::lock_guard lock(mutex);
    lost = std::exchange(exposures_to_lose, 0);
  }
  for (unsigned i = 0; i < lost; ++i) static_cast<void>(expose());
  const cv::Mat1w counts = expose();
  // The buffer was allocated for the geometry in the registers, which a client that ignores read-only may have changed.
  const bool fits = read(ARV_FAKE_CAMERA_REGISTER_WIDTH) == static_cast<std::uint32_t>(config.width) &&
                    read(ARV_FAKE_CAMERA_REGISTER_HEIGHT) == static_cast<std::uint32_t>(config.height) &&
                    (format == mono14 || format == mono16);
  const std::lock_guard lock(mutex);
  // Ids follow 65535 with 1.
  const auto id = static_cast<std::uint16_t>((next_frame_id - 1U + lost) % 65535U + 1U);
  next_frame_id = static_cast<std::uint16_t>(id % 65535U + 1U);
  arv_buffer_set_frame_id(buffer, id);
  arv_buffer_set_timestamp(buffer, clock_ns);
  if (!counts.empty()) last_sent = processed(counts, format);
  if (!fits) return;
  // The reported size is 0 in this callback; the memory behind the pointer is the whole payload.
  std::size_t unused = 0;
  auto* out = static_cast<std::uint8_t*>(const_cast<void*>(arv_buffer_get_data(buffer, &unused)));
  const bool big_endian = read(register_big_endian) != 0;
  for (const auto count : last_sent) {
    const auto low = static_cast<std::uint8_t>(count & 0xFF);
    const auto high = static_cast<std::uint8_t>(count >> 8);
    *out++ = big_endian ? high : low;
    *out++ = big_endian ? low : high;
  }
}

EmulatedGigeCamera::EmulatedGigeCamera(std::unique_ptr<State> state) : state_(std::move(state)) {}
EmulatedGigeCamera::~EmulatedGigeCamera() = default;

Result<std::unique_ptr<EmulatedGigeCamera>> EmulatedGigeCamera::start(EmulatedGigeCameraConfig config,
                                                                      Exposure exposure, NucObserver on_nuc) {
  if (const auto valid = validate(config); !valid) return tl::unexpected(valid.error());
  if (!exposure) return fail(ErrorCode::invalid_input, "emulated camera: there is nothing to expose");
  const std::string address = config.interface_address;
  auto state = std::make_unique<State>();
  state->config = std::move(config);
  state->exposure = std::move(exposure);
  state->on_nuc = std::move(on_nuc);
  const MemoryFile description(gige_camera_xml());
  state->camera.reset(
      arv_gv_fake_camera_new_full(address.c_str(), state->config.serial.c_str(), description.path().c_str()));
  if (!state->camera || arv_gv_fake_camera_is_running(state->camera.get()) == 0) {
    return fail(ErrorCode::not_found,
                "emulated camera: no interface with address " + address + " is up, or its UDP port 3956 is busy");
  }
  state->registers.reset(ARV_FAKE_CAMERA(g_object_ref(arv_gv_fake_camera_get_fake_camera(state->camera.get()))));
  state->power_up();
  // is_running says true even when the port was taken, and a client would then drive somebody else's camera. Only the
  // answer over the wire tells: a value that no other camera has (clock and process) must come back.
  const auto now = std::chrono::steady_clock::now().time_since_epoch().count();
  const auto instance = static_cast<std::uint32_t>(now ^ (now >> 32) ^ (std::int64_t{getpid()} << 12));
  state->write(register_instance, instance);
  const auto answer = gvcp_read_register(address, register_instance, 2s);
  if (!answer || *answer != instance) {
    return fail(ErrorCode::not_found, "emulated camera: UDP port 3956 of " + address + " is busy" +
                                          (answer ? ": another camera answers there" : ""));
  }
  state->poll = std::jthread([raw = state.get()](const std::stop_token& stop) {
    std::mutex idle;
    std::unique_lock lock(idle);
    while (!stop.stop_requested()) {
      raw->polled.wait_for(lock, stop, command_poll_period, [] { return false; });
      if (!stop.stop_requested()) raw->serve_commands();
    }
  });
  return std::unique_ptr<EmulatedGigeCamera>(new EmulatedGigeCamera(std::move(state)));
}

const EmulatedGigeCameraConfig& EmulatedGigeCamera::config() const {
  return state_->config;
}

std::uint64_t EmulatedGigeCamera::exposures() const {
  const std::lock_guard lock(state_->mutex);
  return state_->exposures;
}

std::uint64_t EmulatedGigeCamera::failed_exposures() const {
  const std::lock_guard lock(state_->mutex);
  return state_->failed_exposures;
}

std::uint64_t EmulatedGigeCamera::nonuniformity_corrections() const {
  const std::lock_guard lock(state_->mutex);
  return state_->corrections;
}

void EmulatedGigeCamera::set_device_temperature_c(double temperature_c) {
  state_->write(register_device_temperature, static_cast<std::uint32_t>(std::lround(100 * temperature_c)));
}

void EmulatedGigeCamera::set_packet_loss(double probability, std::uint32_t seed) {
  g_random_set_seed(seed);
  g_object_set(state_->camera.get(), "gvsp-lost-ratio", probability, nullptr);
}

void EmulatedGigeCamera::lose_exposures(unsigned count) {
  const std::lock_guard lock(state_->mutex);
  state_->exposures_to_lose += count;
}

std::uint64_t exposure_index(const Frame& frame, double frame_rate_hz) {
  const auto period_ns = 1000 * static_cast<std::int64_t>(std::lround(1e6 / frame_rate_hz));
  return static_cast<std::uint64_t>(frame.device_time_ns / period_ns) - 1;
}

}  // namespace todbench
