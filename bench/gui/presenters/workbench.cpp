// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/presenters/workbench.h"

#include <algorithm>
#include <utility>

#include "acquisition/base/try.h"
#include "acquisition/core/camera_id.h"
#include "bench/devices/devices.h"
#include "bench/gui/presenters/device_plan.h"
#include "bench/plan/descriptions.h"
#include "bench/plan/resources.h"
#include "tod/presentation/target_failure.h"

namespace todbench {
namespace {

std::vector<DeviceEntry> built_in_devices() {
  std::vector<DeviceEntry> entries;
#ifdef TODBENCH_WITH_ARAVIS
  entries.push_back({.id = emulated_laboratory,
                     .group = "Emulated",
                     .label = "Emulated laboratory",
                     .detail = "GigE camera, black body and plate stage on the loopback interface",
                     .health = DeviceHealth::ready});
#endif
  for (const auto& name : resource_names(ResourceKind::sensor)) {
    entries.push_back({.id = QString::fromStdString(camera_id(camera_scheme::sim, name)),
                       .group = "Simulated sensors",
                       .label = QString::fromStdString(name),
                       .detail = "Sensor model; the processor limits the frame rate",
                       .health = DeviceHealth::ready});
  }
  return entries;
}

/// The device behind the camera of a plan: the plans of the emulated laboratory name its address.
QString device_of(const Plan& plan) {
#ifdef TODBENCH_WITH_ARAVIS
  if (plan.camera.id == camera_id(camera_scheme::gige, "127.0.0.1")) return emulated_laboratory;
#endif
  return QString::fromStdString(plan.camera.id);
}

}  // namespace

Remedy remedy_of(const Error& error) {
  switch (error.code) {
    case ErrorCode::not_found:
    case ErrorCode::disconnected:
    case ErrorCode::timeout:
    case ErrorCode::integrity:
      return Remedy::try_again;
    default:
      return Remedy::none;
  }
}

QString name_of(DeviceHealth health) {
  switch (health) {
    case DeviceHealth::ready:
      return "ready";
    case DeviceHealth::in_use:
      return "in use";
    case DeviceHealth::lost:
      return "lost";
  }
  return {};
}

QString name_of(Activity activity) {
  switch (activity) {
    case Activity::idle:
      return "idle";
    case Activity::looking:
      return "looking";
    case Activity::aligning:
      return "aligning";
    case Activity::measuring:
      return "measuring";
    case Activity::replaying:
      return "replaying";
  }
  return {};
}

Workbench::Workbench(std::filesystem::path sessions, QObject* parent)
    : QObject(parent), sessions_(std::move(sessions)), devices_(built_in_devices()) {
  if (auto plan = load_plan("demo")) plan_ = std::move(*plan);
  if (devices_.front().id != device_) (void)select_device(devices_.front().id);
}

Workbench::~Workbench() = default;

void Workbench::set_plan(const Plan& plan) {
  const bool other = !plan.camera.id.empty() && plan.camera.id != plan_.camera.id;
  plan_ = plan;
  emit plan_changed();
  if (!other) return;
  const QString device = device_of(plan);
  if (device == device_) return;
  // A run has its own copy of the plan and goes on.
  if (activity_ == Activity::looking || activity_ == Activity::aligning) stop();
  device_ = device;
  const bool listed =
      std::any_of(devices_.begin(), devices_.end(), [&](const DeviceEntry& entry) { return entry.id == device; });
  if (!listed) {
    devices_.push_back({.id = device, .group = "Camera of the plan", .label = device, .detail = "named by the plan"});
    emit devices_changed();
  }
  emit device_selected();
}

Result<void> Workbench::select_device(const QString& id) {
  Plan plan;
  if (id == emulated_laboratory) {
    plan = plan_for_laboratory(plan_);
  } else if (const auto name = camera_name(id.toStdString(), camera_scheme::sim)) {
    TODBENCH_TRY(plan, plan_for_sensor(plan_, *name));
  } else {
    plan = plan_for_camera(plan_, id.toStdString());
  }
  if (device_ != id) stop();
  device_ = id;
  plan_ = std::move(plan);
  emit plan_changed();
  emit device_selected();
  return {};
}

void Workbench::rescan() {
  scan_.start([this](const std::stop_token&) {
    auto listing = camera_registry().list();
    // The emulated laboratory and the shipped sensors are in the list anyway.
    const std::string own = laboratory_serial();
    std::erase_if(listing.cameras, [&](const CameraEntry& camera) {
      return camera_name(camera.id, camera_scheme::sim) ||
             (!own.empty() && camera.serial == own && camera.address.starts_with("127."));
    });
    post([this, listing] {
      auto entries = built_in_devices();
      for (const auto& camera : listing.cameras) {
        entries.push_back({.id = QString::fromStdString(camera.id),
                           .group = QString::fromStdString(camera.transport),
                           .label = QString::fromStdString(camera.vendor + " " + camera.model),
                           .serial = QString::fromStdString(camera.serial),
                           .detail = QString::fromStdString("serial number " + camera.serial +
                                                            (camera.address.empty() ? "" : ", at " + camera.address)),
                           .health = DeviceHealth::ready});
      }
      for (auto& entry : entries) {
        const auto before = std::find_if(devices_.begin(), devices_.end(),
                                         [&](const DeviceEntry& known) { return known.id == entry.id; });
        if (before != devices_.end()) entry.health = before->health;
      }
      devices_ = std::move(entries);
      emit devices_changed();
      for (const auto& warning : listing.warnings) emit noted(QString::fromStdString(warning));
    });
  });
}

std::string Workbench::laboratory_serial() {
#ifdef TODBENCH_WITH_ARAVIS
  const std::lock_guard lock(laboratory_mutex_);
  if (laboratory_) return laboratory_is_->serial;
#endif
  return {};
}

Result<Plan> Workbench::with_devices(Plan plan, const QString& device, const std::stop_token& stop) {
  if (stop.stop_requested()) return fail(ErrorCode::interrupted, "stopped on request");
  if (device != emulated_laboratory) return plan;
#ifdef TODBENCH_WITH_ARAVIS
  const EmulationArguments wanted = emulation_for(plan);
  const std::lock_guard lock(laboratory_mutex_);
  if (!laboratory_ || laboratory_is_ != wanted) {
    laboratory_.reset();
    auto laboratory = start_laboratory(wanted);
    if (!laboratory) return fail("starting the emulated laboratory", laboratory.error());
    laboratory_ = std::move(*laboratory);
    laboratory_is_ = wanted;
  }
  return with_laboratory(std::move(plan), *laboratory_);
#else
  return fail(ErrorCode::not_found,
              "this build has no camera libraries and cannot emulate the laboratory; choose a simulated sensor");
#endif
}

void Workbench::run(Activity activity, DeviceJob job) {
  set_health(DeviceHealth::in_use);
  begin(activity, Devices::needed, std::move(job));
}

void Workbench::run_without_devices(Activity activity, DeviceJob job) {
  set_health(DeviceHealth::ready);
  begin(activity, Devices::none, std::move(job));
}

void Workbench::begin(Activity activity, Devices devices, DeviceJob job) {
  const std::uint64_t number = ++run_;
  set_activity(activity);
  bench_.start(
      [this, number, devices, plan = plan_, device = device_, job = std::move(job)](const std::stop_token& stop) {
        Result<void> result;
        if (auto ready = devices == Devices::none ? Result<Plan>(plan) : with_devices(plan, device, stop)) {
          result = job(*ready, stop);
        } else {
          result = tl::unexpected(ready.error());
        }
#ifdef TODBENCH_WITH_ARAVIS
        // A laboratory without its camera or an instrument is useless: the next run starts another.
        if (!result && result.error().code == ErrorCode::disconnected) {
          const std::lock_guard lock(laboratory_mutex_);
          laboratory_.reset();
        }
#endif
        post([this, number, result] { ended(number, result); });
      });
}

void Workbench::stop() {
  // A dropped job does not report its end.
  if (bench_.stop() == JobRunner::Waiting::dropped) {
    ++run_;
    set_activity(Activity::idle);
    set_health(DeviceHealth::ready);
  }
}

void Workbench::ended(std::uint64_t run, const Result<void>& result) {
  if (run != run_) return;
  const bool failed = !result && result.error().code != ErrorCode::interrupted;
  const bool lost = failed && !is_target_failure(result.error()) &&
                    (result.error().code == ErrorCode::disconnected || result.error().code == ErrorCode::not_found);
  set_health(lost ? DeviceHealth::lost : DeviceHealth::ready);
  set_activity(Activity::idle);
  if (failed) emit trouble(QString::fromStdString(result.error().message), remedy_of(result.error()));
}

void Workbench::switch_emulated_camera_off() {
#ifdef TODBENCH_WITH_ARAVIS
  const std::lock_guard lock(laboratory_mutex_);
  if (laboratory_) laboratory_->switch_camera_off();
#endif
}

void Workbench::shut_down() {
  scan_.shut_down();
  bench_.shut_down();
}

void Workbench::post(std::function<void()> what) {
  QMetaObject::invokeMethod(this, std::move(what), Qt::QueuedConnection);
}

void Workbench::note(const std::string& sentence) {
  post([this, text = QString::fromStdString(sentence)] { emit noted(text); });
}

void Workbench::set_activity(Activity activity) {
  if (activity_ == activity) return;
  activity_ = activity;
  emit activity_changed();
}

void Workbench::set_health(DeviceHealth health) {
  for (auto& entry : devices_) {
    if (entry.id == device_) {
      entry.health = health;
    } else if (entry.health == DeviceHealth::in_use) {
      entry.health = DeviceHealth::ready;
    }
  }
  emit devices_changed();
}

}  // namespace todbench
