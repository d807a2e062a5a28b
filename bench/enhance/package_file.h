// SPDX-License-Identifier: GPL-3.0-or-later
// An enhancement package: a sequence of stages behind the camera, read from a file.
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

/// One stage. Each number belongs to the kind in its comment.
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
struct EnhancementPackage {
  std::string name, description;
  std::vector<StagePlan> stages;
  std::string text, sha256;             ///< of the file
  std::vector<std::string> provenance;  ///< of its modules: command, version, hashes of the files they name
};

/// Reads name, description, and [[stage]] with kind and its numbers; kind "module" has command, version, parameters,
/// limit_ms, memory_mib, restart_frames, network, settle_frames. Commands run in the current folder of the caller.
/// Errors: `invalid_input` "FILE:LINE: ..." in one sentence.
[[nodiscard]] Result<EnhancementPackage> read_package(const std::filesystem::path& file);

/// Returns `invalid_input` in one sentence for a package with super-resolution. `what`: the user of the package, which
/// needs the camera's own pixels.
[[nodiscard]] Result<void> refuse_finer_pictures(const EnhancementPackage& package, std::string_view what);

/// Largest distance, in samples, over which a picture influences a sample behind the stages; empty: the whole picture
/// does.
[[nodiscard]] std::optional<int> reach_px(const EnhancementPackage& package);

/// Stages of a package, made anew for every use, and their reach.
struct PackageStages {
  std::function<std::vector<std::unique_ptr<ChainStage>>()> stages;
  std::optional<int> reach_px{};  ///< as reach_px()
};
/// Reads a package whose pictures must have the camera's own pixels. Errors: those of read_package() and
/// refuse_finer_pictures().
[[nodiscard]] Result<PackageStages> read_package_stages(const std::filesystem::path& file, std::string_view what);

/// Creates the stages, ready for the first picture.
[[nodiscard]] std::vector<std::unique_ptr<ChainStage>> made_stages(
    const EnhancementPackage& package, const std::function<void(std::string_view line)>& on_error_line);

}  // namespace todbench
