// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/lab/gige/gige_camera.h"

#include <arv.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cmath>
#include <condition_variable>
#include <cstring>
#include <mutex>
#include <optional>
#include <string_view>
#include <thread>
#include <vector>

#include "acquisition/aravis/gev_registers.h"
#include "acquisition/aravis/gvcp_client.h"
#include "acquisition/base/descriptor.h"
#include "acquisition/base/try.h"
#include "sim_devices/lab/genicam/picture_encoder.h"
#include "sim_devices/lab/genicam/thermal_features.h"

namespace todbench {

namespace {

using namespace std::chrono_literals;

/// Registers of this camera in addition to those of Aravis' fake camera.
constexpr std::uint32_t register_ir_format = 0xA000;
constexpr std::uint32_t register_nuc_mode = 0xA004;
constexpr std::uint32_t register_nuc_action = 0xA008;
constexpr std::uint32_t register_noise_reduction = 0xA00C;
constexpr std::uint32_t register_device_temperature = 0xA010;
constexpr std::uint32_t register_nuc_interval = 0xA014;
constexpr std::uint32_t register_payload_size = 0xA018;
constexpr std::uint32_t register_largest_count = 0xA01C;
constexpr std::uint32_t register_big_endian = 0xA020;
constexpr std::uint32_t register_instance = 0xA024;
constexpr std::uint32_t register_linear_scale = 0xA040;
constexpr std::uint32_t register_linear_offset = 0xA048;
constexpr std::uint32_t register_planck = 0xA050;  ///< R, B, F, O, eight bytes each

constexpr ThermalRegisters registers_of_this{.vendor = gev::vendor_name,
                                             .model = gev::model_name,
                                             .firmware = gev::device_version,
                                             .serial = gev::serial_number,
                                             .name_bytes = 32,
                                             .serial_bytes = 16,
                                             .width = ARV_FAKE_CAMERA_REGISTER_WIDTH,
                                             .height = ARV_FAKE_CAMERA_REGISTER_HEIGHT,
                                             .offset_x = ARV_FAKE_CAMERA_REGISTER_X_OFFSET,
                                             .offset_y = ARV_FAKE_CAMERA_REGISTER_Y_OFFSET,
                                             .pixel_format = ARV_FAKE_CAMERA_REGISTER_PIXEL_FORMAT,
                                             .largest_count = register_largest_count,
                                             .payload_size = register_payload_size,
                                             .acquisition_mode = ARV_FAKE_CAMERA_REGISTER_ACQUISITION_MODE,
                                             .acquisition = ARV_FAKE_CAMERA_REGISTER_ACQUISITION,
                                             .period_us = ARV_FAKE_CAMERA_REGISTER_ACQUISITION_FRAME_PERIOD_US,
                                             .ir_format = register_ir_format,
                                             .linear_scale = register_linear_scale,
                                             .linear_offset = register_linear_offset,
                                             .nuc_mode = register_nuc_mode,
                                             .nuc_action = register_nuc_action};

std::uint32_t raw_temperature(double temperature_c) {
  return static_cast<std::uint32_t>(std::lround(100 * temperature_c));
}

/// The camera of thermal_camera() with the features that only this one has.
CameraDescription described(const EmulatedGigeCameraConfig& c) {
  using namespace features;
  auto camera = thermal_camera(registers_of_this, options_of(c));
  const auto width = static_cast<std::uint32_t>(c.width), height = static_cast<std::uint32_t>(c.height);
  more_of(camera, "DeviceControl")
      .push_back(
          temperature("DeviceTemperature", register_device_temperature, 0.01, raw_temperature(c.device_temperature_c)));
  auto& image = more_of(camera, "ImageFormatControl");
  image.push_back(state("SensorWidth", ARV_FAKE_CAMERA_REGISTER_SENSOR_WIDTH, width));
  image.push_back(state("SensorHeight", ARV_FAKE_CAMERA_REGISTER_SENSOR_HEIGHT, height));
  auto& formats = feature_named(camera, "IRFormat").entries;
  formats.insert(formats.begin(), {"Radiometric", ir_format_radiometric});
  feature_named(camera, "NUCMode").entries.emplace_back("Automatic", nuc_mode_automatic);
  auto& thermal = more_of(camera, "ThermalControl");
  const PlanckScale& planck = c.radiometric;
  thermal.push_back(real("R", register_planck, planck.r));
  thermal.push_back(real("B", register_planck + 8, planck.b));
  thermal.push_back(real("F", register_planck + 16, planck.f));
  thermal.push_back(real("O", register_planck + 24, planck.o));
  thermal.push_back(
      {.name = "NUCIntervalFrames", .address = register_nuc_interval, .initial = 9000, .least = 1, .most = 1'000'000});
  thermal.push_back(choice("NoiseReduction", register_noise_reduction, 1, {{"Off", 0}, {"On", 1}}));
  // The fake camera keeps only the packet size in its register.
  more_of(camera, "TransportLayerControl")
      .push_back({.name = "GevSCPSBigEndian",
                  .kind = FeatureKind::bit,
                  .address = register_big_endian,
                  .bit = 31,
                  .about = "Sends the high byte of a pixel first."});
  return camera;
}

/// Interval at which commands are noticed as long as no frame is exposed.
constexpr auto command_poll_period = 20ms;

/// A file in memory, for a library that expects a path.
class MemoryFile {
 public:
  explicit MemoryFile(std::string_view content) : fd_(memfd_create("genicam", MFD_CLOEXEC)) {
    std::size_t written = 0;
    while (fd_.is_open() && written < content.size()) {
      const auto size = ::write(fd_.get(), content.data() + written, content.size() - written);
      if (size <= 0) break;
      written += static_cast<std::size_t>(size);
    }
  }
  [[nodiscard]] std::string path() const { return "/proc/self/fd/" + std::to_string(fd_.get()); }

 private:
  Descriptor fd_;
};

struct Unref {
  void operator()(void* object) const { g_object_unref(object); }
};

Result<void> validate(const EmulatedGigeCameraConfig& config) {
  const auto bad = [](const std::string& what) { return fail(ErrorCode::invalid_input, "emulated camera: " + what); };
  TODBENCH_TRY_VOID(validate_emulation("emulated camera", config));
  if (config.serial.size() > 15) return bad("serial must have 1 ... 15 characters");
  if (config.vendor.size() > 31 || config.model.size() > 31 || config.firmware.size() > 31) {
    return bad("vendor, model and firmware must have at most 31 characters");
  }
  if (config.first_frame_id == 0) return bad("first_frame_id must not be 0");
  return {};
}

}  // namespace

struct EmulatedGigeCamera::State {
  EmulatedGigeCameraConfig config;
  Exposure exposure;
  NucObserver on_nuc;
  CameraDescription description;
  std::optional<PictureEncoder> encoder;  ///< used by the camera's thread

  mutable std::mutex mutex;  ///< guards all members down to `polled`
  std::uint64_t exposures = 0;
  std::uint64_t failed_exposures = 0;
  std::uint64_t corrections = 0;
  std::uint64_t clock_ns = 0;
  unsigned exposures_to_lose = 0;
  unsigned frozen_frames = 0;
  std::uint16_t next_frame_id = 1;
  std::vector<std::uint8_t> last_sent;
  std::condition_variable_any polled;

  std::unique_ptr<ArvFakeCamera, Unref> registers;  ///< outlives the camera's thread, which reads it
  std::unique_ptr<ArvGvFakeCamera, Unref> camera;
  std::jthread poll;  ///< last member: stops before anything that it uses is destroyed

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
  void power_up();
  void serve_commands();
  void begin_correction();
  [[nodiscard]] cv::Mat1w expose();
  [[nodiscard]] EncoderSettings encoder_settings(PixelFormat format) const;
  void fill(ArvBuffer* buffer, ArvPixelFormat format);
  static void on_fill(ArvBuffer* buffer, void* state, guint32, guint32, ArvPixelFormat format) {
    static_cast<State*>(state)->fill(buffer, format);
  }
};

void EmulatedGigeCamera::State::power_up() {
  for (const auto& [address, bytes] : power_up_contents(description)) {
    arv_fake_camera_write_memory(registers.get(), address, static_cast<guint32>(bytes.size()), bytes.data());
  }
  next_frame_id = config.first_frame_id;
  encoder.emplace(config.kelvin_per_count, config.offset_k, config.radiometric);
  // Since the first development release for Aravis 0.10 with a function that frees the data.
#if ARAVIS_CHECK_VERSION(0, 9, 0)
  arv_fake_camera_set_fill_pattern(registers.get(), &State::on_fill, this, nullptr);
#else
  arv_fake_camera_set_fill_pattern(registers.get(), &State::on_fill, this);
#endif
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
    // No exception may propagate into the calling C library; the owner reads the count.
    counts = {};
  }
  if (counts.cols == config.width && counts.rows == config.height) return counts;
  const std::lock_guard lock(mutex);
  ++failed_exposures;
  return cv::Mat1w::zeros(config.height, config.width);
}

EncoderSettings EmulatedGigeCamera::State::encoder_settings(PixelFormat format) const {
  EncoderSettings settings;
  const auto ir_format = read(register_ir_format);
  if (ir_format == ir_format_radiometric) settings.signal = SignalKind::radiometric;
  if (ir_format == ir_format_100mk) settings.signal = SignalKind::tenths;
  settings.significant_bits = static_cast<unsigned>(config.significant_bits);
  settings.format = format;
  settings.averages = read(register_noise_reduction) != 0;
  settings.big_endian = read(register_big_endian) != 0;
  return settings;
}

void EmulatedGigeCamera::State::fill(ArvBuffer* buffer, ArvPixelFormat format) {
  unsigned lost = 0;
  {
    const std::lock_guard lock(mutex);
    lost = std::exchange(exposures_to_lose, 0);
  }
  for (unsigned i = 0; i < lost; ++i) static_cast<void>(expose());
  const cv::Mat1w counts = expose();
  // The buffer has the geometry of the registers, which a client that ignores read-only may have changed.
  const auto known = pixel_format_of_pfnc(format);
  const bool fits = read(ARV_FAKE_CAMERA_REGISTER_WIDTH) == static_cast<std::uint32_t>(config.width) &&
                    read(ARV_FAKE_CAMERA_REGISTER_HEIGHT) == static_cast<std::uint32_t>(config.height) &&
                    (known == PixelFormat::mono14 || known == PixelFormat::mono16);
  const std::lock_guard lock(mutex);
  // The id after 65535 is 1.
  const auto id = static_cast<std::uint16_t>((next_frame_id - 1U + lost) % 65535U + 1U);
  next_frame_id = static_cast<std::uint16_t>(id % 65535U + 1U);
  arv_buffer_set_frame_id(buffer, id);
  arv_buffer_set_timestamp(buffer, clock_ns);
  if (!fits) return;
  if (!counts.empty()) last_sent = encoder->encode(counts, encoder_settings(*known));
  // The reported size is 0 in this callback; the memory behind the pointer is the whole payload.
  std::size_t unused = 0;
  std::memcpy(const_cast<void*>(arv_buffer_get_data(buffer, &unused)), last_sent.data(), last_sent.size());
}

EmulatedGigeCamera::EmulatedGigeCamera(std::unique_ptr<State> state) : state_(std::move(state)) {}
EmulatedGigeCamera::~EmulatedGigeCamera() = default;

Result<std::unique_ptr<EmulatedGigeCamera>> EmulatedGigeCamera::start(EmulatedGigeCameraConfig config,
                                                                      Exposure exposure, NucObserver on_nuc) {
  TODBENCH_TRY_VOID(validate(config));
  if (!exposure) return fail(ErrorCode::invalid_input, "emulated camera: the exposure function is missing");
  const std::string address = config.interface_address;
  auto state = std::make_unique<State>();
  state->config = std::move(config);
  state->exposure = std::move(exposure);
  state->on_nuc = std::move(on_nuc);
  state->description = described(state->config);
  const MemoryFile file(genicam_xml(state->description));
  state->camera.reset(arv_gv_fake_camera_new_full(address.c_str(), state->config.serial.c_str(), file.path().c_str()));
  if (!state->camera || arv_gv_fake_camera_is_running(state->camera.get()) == 0) {
    return fail(ErrorCode::not_found,
                "emulated camera: no interface with address " + address + " is up, or its UDP port 3956 is busy");
  }
  state->registers.reset(ARV_FAKE_CAMERA(g_object_ref(arv_gv_fake_camera_get_fake_camera(state->camera.get()))));
  state->power_up();
  // is_running is true even if the port was taken, and a client would then control a foreign camera. Only an answer
  // over the wire is proof: a value that no other camera has (clock and process) must be returned.
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
  state_->write(register_device_temperature, raw_temperature(temperature_c));
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
