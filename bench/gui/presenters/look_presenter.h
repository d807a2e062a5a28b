// SPDX-License-Identifier: GPL-3.0-or-later
// The live picture: choice of the camera, colours of its counts, value under the cursor.
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

/// Level and span: from the picture, or fixed.
enum class LevelMode { automatic, fixed };

/// Values of one pixel.
struct PixelReading {
  int column = 0, row = 0;
  int counts = 0;
  std::optional<double> kelvin;  ///< empty without a temperature scale
};

/// Takes the latest frame 25 times a second from the running camera. Used in the window's thread.
class LookPresenter final : public QObject {
  Q_OBJECT

 public:
  explicit LookPresenter(Workbench& bench, QObject* parent = nullptr);

  /// Runs the selected camera. A target that the plan can drive is asked for the plan's highest contrast at the same
  /// time; the picture does not wait for it, and its failure is a message.
  void start();
  void stop() { bench_.stop(); }

  [[nodiscard]] const std::optional<LiveFrame>& latest() const { return latest_; }
  [[nodiscard]] const QImage& image() const { return image_; }
  [[nodiscard]] const std::vector<int>& histogram() const { return histogram_; }
  [[nodiscard]] const std::vector<cv::Point>& dead() const { return dead_; }
  [[nodiscard]] LevelSpan level() const { return level_; }
  [[nodiscard]] LevelMode level_mode() const { return mode_; }
  [[nodiscard]] ColourMap colour_map() const { return map_; }
  void set_colour_map(ColourMap map);
  void set_level_mode(LevelMode mode);
  /// Fixes level and span, in counts; span is at least 1.
  void set_level(double level, double span);
  void set_marks(bool on);

  /// Empty outside the picture and before the first frame.
  [[nodiscard]] std::optional<PixelReading> reading(int column, int row) const;
  /// "12 good, 1 incomplete, 2 lost, 50.0 Hz, buffer 33554432 bytes".
  [[nodiscard]] QString counters() const;
  /// Settings read from the camera, as text; empty before the first frame.
  [[nodiscard]] QString camera() const;

  /// Settings of the running camera, in the order of all_camera_controls; empty before it runs.
  [[nodiscard]] const std::vector<ControlReading>& controls() const { return controls_; }
  /// Sets a feature of the running camera. The plan states the new value in [camera] settings, so that a measurement
  /// uses it. controls_changed() follows; a refusal is a trouble of the workbench.
  void change(const std::string& feature, const std::string& value);
  /// Commands a non-uniformity correction.
  void correct();
  /// Writes the latest frame as a TIFF of 16 bits into the folder of the sessions, and returns the file. Errors: `io`;
  /// `invalid_input` without a frame.
  Result<std::filesystem::path> snapshot();
  /// Records the frames that follow into the folder of the sessions, or ends the recording.
  void toggle_recording();
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
