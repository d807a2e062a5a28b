// SPDX-License-Identifier: GPL-3.0-or-later
// State shared by all views: the plan, the devices, the device thread, the live pictures.
#pragma once

#include <QObject>
#include <QString>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "bench/devices/emulation.h"
#include "bench/gui/presenters/job_runner.h"
#include "bench/gui/presenters/live_feed.h"
#include "bench/plan/plan.h"

namespace todbench {

/// State of a device, as shown on its badge.
enum class DeviceHealth { ready, in_use, lost };
/// Returns the state in words.
[[nodiscard]] QString name_of(DeviceHealth health);

/// Device in the list.
struct DeviceEntry {
  QString id;     ///< id of a camera, or `emulated_laboratory`
  QString group;  ///< "Emulated", "Simulated", "GigE Vision", ...
  QString label;
  QString serial{};  ///< empty: unknown or none
  QString detail;
  DeviceHealth health = DeviceHealth::ready;
};
inline constexpr const char* emulated_laboratory = "emulated";

/// Current activity of the bench. There is one at a time.
enum class Activity { idle, looking, aligning, measuring, replaying };
/// Returns the activity in words.
[[nodiscard]] QString name_of(Activity activity);

/// Possible action of the user after an error.
enum class Remedy {
  try_again,  ///< the same action may succeed the next time: a device is absent, lost or late
  none,       ///< the same action fails again until a value, a file or a setting is changed
};
/// Returns the action that can help after an error.
[[nodiscard]] Remedy remedy_of(const Error& error);

/// State of the bench. Lives in the window's thread; members marked "any thread" may be called from jobs.
class Workbench final : public QObject {
  Q_OBJECT

 public:
  /// Creates the workbench. Sessions are read from and written to `sessions`.
  explicit Workbench(std::filesystem::path sessions, QObject* parent = nullptr);
  ~Workbench() override;

  [[nodiscard]] const Plan& plan() const { return plan_; }
  /// Replaces the plan. If the plan names a different camera, that camera becomes the device.
  void set_plan(const Plan& plan);
  [[nodiscard]] const std::filesystem::path& sessions_folder() const { return sessions_; }

  /// Returns the known devices.
  [[nodiscard]] const std::vector<DeviceEntry>& devices() const { return devices_; }
  /// Returns the id of the selected device.
  [[nodiscard]] QString device() const { return device_; }
  /// Puts the device into the plan (bench/gui/presenters/device_plan.h). Errors: `invalid_input` for an unreadable
  /// simulated sensor.
  [[nodiscard]] Result<void> select_device(const QString& id);
  /// Searches for cameras; devices_changed() follows.
  void rescan();

  [[nodiscard]] Activity activity() const { return activity_; }
  /// Stops the running job and runs a new job with the devices. `job` is called on the device thread with the plan,
  /// when its devices are ready. If it returns an error other than `interrupted`, trouble() is emitted.
  using DeviceJob = std::function<Result<void>(const Plan&, std::stop_token)>;
  void run(Activity activity, DeviceJob job);
  /// Runs a job without devices, as run() does, with the unchanged plan.
  void run_without_devices(Activity activity, DeviceJob job);
  /// Stops the running job.
  void stop();
  /// Ends all jobs and waits for them. Call it before objects that a job uses are destroyed.
  void shut_down();
  [[nodiscard]] LiveFeed& feed() { return feed_; }

  /// Switches the emulated camera off, as if its cable was pulled, for demonstrations and tests. Any thread.
  void switch_emulated_camera_off();

  /// Sets the state of the device as a job observed it. Window's thread.
  void report_health(DeviceHealth health) { set_health(health); }

  /// Calls `what` in the window's thread, if the workbench still exists. Any thread.
  void post(std::function<void()> what);
  /// Shows a message to the user. Any thread.
  void note(const std::string& sentence);

 signals:
  void plan_changed();
  void devices_changed();
  void device_selected();
  void activity_changed();
  void noted(const QString& sentence);
  /// An error occurred; the window offers the remedy.
  void trouble(const QString& sentence, Remedy remedy);

 private:
  /// Returns the serial number of the camera of the window's own emulated laboratory; empty if there is no laboratory.
  /// Any thread.
  [[nodiscard]] std::string laboratory_serial();
  [[nodiscard]] Result<Plan> with_devices(Plan plan, const QString& device, const std::stop_token& stop);
  enum class Devices { needed, none };
  void begin(Activity activity, Devices devices, DeviceJob job);
  void set_activity(Activity activity);
  void set_health(DeviceHealth health);
  void ended(std::uint64_t run, const Result<void>& result);

  std::filesystem::path sessions_;
  Plan plan_;
  QString device_ = emulated_laboratory;
  std::vector<DeviceEntry> devices_;
  Activity activity_ = Activity::idle;
  std::uint64_t run_ = 0;  ///< number of the last run; the end of an older run is ignored
  LiveFeed feed_;
#ifdef TODBENCH_WITH_ARAVIS
  std::mutex laboratory_mutex_;
  std::unique_ptr<Laboratory> laboratory_;
  std::optional<EmulationArguments> laboratory_is_;
#endif
  JobRunner scan_, bench_;  // last: their jobs use everything above
};

}  // namespace todbench
