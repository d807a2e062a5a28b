// SPDX-License-Identifier: GPL-3.0-or-later
// Live picture: choice of the camera, colours for its counts, value under the cursor.
#pragma once

#include <QImage>
#include <QObject>
#include <QString>
#include <QTimer>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bench/gui/presenters/camera_desk.h"
#include "bench/gui/presenters/colour_map.h"
#include "bench/gui/presenters/live_feed.h"
#include "bench/gui/presenters/workbench.h"

namespace todbench {

/// Source of level and span: the picture, or fixed values.
enum class LevelMode { automatic, fixed };

/// Values of one pixel.
struct PixelReading {
  int column = 0, row = 0;
  int counts = 0;
  std::optional<double> kelvin;  ///< empty without a temperature scale
};

/// Presenter that takes the latest frame of the running camera 25 times a second. Used in the window's thread.
class LookPresenter final : public QObject {
  Q_OBJECT

 public:
  explicit LookPresenter(Workbench& bench, QObject* parent = nullptr);

  /// Runs the selected camera. At the same time, sets a target that the plan can drive to the highest contrast of the
  /// plan. The picture does not wait for the target. If the target fails, the user gets a message.
  void start();
  void stop() { bench_.stop(); }

  /// Returns the latest frame; empty before the first.
  [[nodiscard]] const std::optional<LiveFrame>& latest() const { return latest_; }
  [[nodiscard]] const QImage& image() const { return image_; }
  /// Returns the number of pixels per bin of counts.
  [[nodiscard]] const std::vector<int>& histogram() const { return histogram_; }
  /// Returns the stuck pixels of the picture.
  [[nodiscard]] const std::vector<cv::Point>& dead() const { return dead_; }
  [[nodiscard]] LevelSpan level() const { return level_; }
  [[nodiscard]] LevelMode level_mode() const { return mode_; }
  [[nodiscard]] ColourMap colour_map() const { return map_; }
  /// Sets the colours of the picture.
  void set_colour_map(ColourMap map);
  /// Sets whether level and span follow the picture.
  void set_level_mode(LevelMode mode);
  /// Fixes level and span, in counts; span is at least 1.
  void set_level(double level, double span);
  /// Switches the marks of saturated and stuck pixels on or off.
  void set_marks(bool on);

  /// Returns the values of a pixel; empty outside the picture and before the first frame.
  [[nodiscard]] std::optional<PixelReading> reading(int column, int row) const;
  /// Returns "12 good, 1 incomplete, 2 lost, 50.0 Hz, buffer 33554432 bytes".
  [[nodiscard]] QString counters() const;
  /// Returns the settings read from the camera, as text; empty before the first frame.
  [[nodiscard]] QString camera() const;

  /// Returns the settings of the running camera, in the order of all_camera_controls; empty before it runs.
  [[nodiscard]] const std::vector<ControlReading>& controls() const { return controls_; }
  /// Sets a feature of the running camera. The new value is also written to [camera] settings of the plan, for use in a
  /// measurement. controls_changed() follows; if the camera rejects the value, the workbench emits trouble().
  void change(const std::string& feature, const std::string& value);
  /// Requests a non-uniformity correction from the camera.
  void correct();
  /// Writes the latest frame as a TIFF of 16 bits into the folder of the sessions, and returns the file. Errors: `io`;
  /// `invalid_input` without a frame.
  Result<std::filesystem::path> snapshot();
  /// Starts to record the next frames into the folder of the sessions, or ends the recording.
  void toggle_recording();
  /// Returns whether frames are being recorded.
  [[nodiscard]] bool recording() const { return desk_->recording(); }

 signals:
  void updated();
  void controls_changed();

 private:
  void take_latest();
  void render();
  void ask(CameraDesk::Request request);
  void report(const Result<void>& done);
  void end_recording();

  Workbench& bench_;
  std::shared_ptr<CameraDesk> desk_ = std::make_shared<CameraDesk>();
  std::vector<ControlReading> controls_;
  std::filesystem::path recorded_;  ///< file of the recording
  QTimer timer_;
  std::optional<LiveFrame> latest_;
  QImage image_;
  std::vector<int> histogram_;
  std::vector<cv::Point> dead_;
  LevelSpan level_;
  LevelMode mode_ = LevelMode::automatic;
  ColourMap map_ = ColourMap::white_hot;
  bool marks_ = true;
};

}  // namespace todbench
