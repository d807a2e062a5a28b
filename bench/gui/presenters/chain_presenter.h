// SPDX-License-Identifier: GPL-3.0-or-later
// Picture of one triangle, or of a scene seen through air, after every stage of the simulated sensor.
#pragma once

#include <QObject>
#include <QString>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bench/gui/presenters/workbench.h"
#include "sim_devices/sensor/sensor_plan.h"

namespace todbench {

/// Sensor and triangle or scene.
struct ChainSettings {
  std::string sensor = "sc2000", observer = "hvs-1";  ///< names or files
  double size_pitch = 3;                              ///< square root of area, in detector pitches
  double delta_t_k = 1;                               ///< contrast of the triangle
  Apex apex = Apex::up;
  std::vector<Effect> skip;  ///< effects that are not simulated
  std::uint64_t seed = 1;
  std::uint64_t index = 0;           ///< number of the exposure
  std::string scene;                 ///< name of a scene that replaces the triangle; empty: the triangle
  std::string atmosphere = "clear";  ///< air between scene and camera
  double range_m = 400;              ///< range from camera to scene
};

/// Stage of the chain.
enum class Stage { scene, optics, detector, samples, noise, quantised, display, observer };
inline constexpr std::array all_stages{Stage::scene, Stage::optics,    Stage::detector, Stage::samples,
                                       Stage::noise, Stage::quantised, Stage::display,  Stage::observer};
/// Returns the label of the stage.
[[nodiscard]] QString name_of(Stage stage);

/// Picture after one stage.
struct StagePicture {
  Stage stage = Stage::scene;
  cv::Mat1d kelvin;             ///< above the surround
  double pixels_per_pitch = 1;  ///< pixels of this picture per detector pitch
  QString note;                 ///< effect of the stage, with numbers
  /// Temperatures that are displayed as black and as white for a scene; equal in all pictures.
  std::optional<std::pair<double, double>> grey_k{};
};

/// Computes the pictures. Scene, optics and detector are sampled 16 times per pitch. The pictures of samples, noise and
/// quantisation are those of the sensor model, with one pixel per sample. The pictures of display and observer are
/// enlarged 8 times. All pictures show the same square. A scene is computed as by `todbench picture` (scene_pictures())
/// at the accuracy `draft`. Errors: those of the loaders.
[[nodiscard]] Result<std::vector<StagePicture>> chain_pictures(const ChainSettings& options);

/// Presenter that computes the pictures in the background. Used in the window's thread.
class ChainPresenter final : public QObject {
  Q_OBJECT

 public:
  explicit ChainPresenter(Workbench& bench, QObject* parent = nullptr);
  [[nodiscard]] const ChainSettings& options() const { return options_; }
  /// Sets the options and computes the pictures; updated() follows.
  void set_options(const ChainSettings& options);
  /// Returns the pictures of the last completed calculation.
  [[nodiscard]] const std::vector<StagePicture>& pictures() const { return pictures_; }
  /// Returns the error of the last calculation; empty if there was none.
  [[nodiscard]] QString problem() const { return problem_; }
  /// Returns whether pictures are being computed.
  [[nodiscard]] bool busy() const { return busy_; }

 signals:
  void updated();

 private:
  Workbench& bench_;
  ChainSettings options_;
  std::vector<StagePicture> pictures_;
  QString problem_;
  bool busy_ = false;
  std::uint64_t request_ = 0;
  JobRunner jobs_;
};

}  // namespace todbench
