// SPDX-License-Identifier: GPL-3.0-or-later
// Enhancement package: a sequence of stages after the camera, read from a file.
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/base/result.h"
#include "sim_devices/module/picture_stage.h"
#include "sim_devices/sensor/super_resolution_stage.h"

namespace todbench {

/// Stage with its parameters. The comment of a parameter states the kind of stage to which it belongs.
struct StagePlan {
  enum class Kind {
    recursive,
    sharpen,
    median,
    clahe,
    plateau,
    module,
    kernel,
    agc,
    super_resolution
  } kind = Kind::recursive;
  double share = 0.5;                                       ///< recursive
  double amount = 1;                                        ///< sharpen
  int size = 3;                                             ///< median
  double clip_limit = 2;                                    ///< clahe
  int tiles = 8;                                            ///< clahe
  double plateau_percent = 1;                               ///< plateau
  ModuleStageOptions module{};                              ///< module
  std::array<double, 9> kernel{0, 0, 0, 0, 1, 0, 0, 0, 0};  ///< kernel
  int plateau_counts = 0;                                   ///< agc
  SuperResolutionStageOptions super_resolution{};           ///< super_resolution
};
/// Content of the file of a package.
struct EnhancementPackage {
  std::string name, description;
  std::vector<StagePlan> stages;
  std::string text, sha256;             ///< content of the file and its SHA-256
  std::vector<std::string> provenance;  ///< origin of the modules: command, version, hashes of the files that they name
};

/// Reads name, description, and [[stage]] with kind and its numbers; kind "module" has command, version, parameters,
/// limit_ms, memory_mib, restart_frames, network, settle_frames. Commands run in the current folder of the caller.
/// Errors: `invalid_input` "FILE:LINE: ...".
[[nodiscard]] Result<EnhancementPackage> read_package(const std::filesystem::path& file);

/// Fails with `invalid_input` for a package with super-resolution. `what`: for the message, the user of the package,
/// which requires pictures with one sample per pixel of the camera.
[[nodiscard]] Result<void> refuse_finer_pictures(const EnhancementPackage& package, std::string_view what);

/// Returns the largest distance, in samples, over which a picture influences a sample after the stages; empty if the
/// whole picture has an influence.
[[nodiscard]] std::optional<int> reach_px(const EnhancementPackage& package);

/// Function that creates new stages of a package for every use, and the reach of these stages.
struct PackageStages {
  std::function<std::vector<std::unique_ptr<ChainStage>>()> stages;
  std::optional<int> reach_px{};  ///< as reach_px()
};
/// Reads a package whose pictures must have one sample per pixel of the camera. Errors: those of read_package() and
/// refuse_finer_pictures().
[[nodiscard]] Result<PackageStages> read_package_stages(const std::filesystem::path& file, std::string_view what);

/// Creates the stages, ready for the first picture.
[[nodiscard]] std::vector<std::unique_ptr<ChainStage>> made_stages(
    const EnhancementPackage& package, const std::function<void(std::string_view line)>& on_error_line);

}  // namespace todbench
