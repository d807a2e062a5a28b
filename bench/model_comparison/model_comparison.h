// SPDX-License-Identifier: GPL-3.0-or-later
// Comparison of two models (sensors, observers or packages of stages) with the same scenes and seeds.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bench/enhance/enhancement.h"
#include "bench/plan/descriptions.h"

namespace todbench {

/// Kind of the compared models; both sides have the same kind.
enum class ModelKind { sensor, observer, package };
/// Returns the name of the kind.
[[nodiscard]] std::string_view to_string(ModelKind kind);

/// One side of the comparison. Only the members that belong to `kind` are set.
struct ComparedModel {
  ModelKind kind = ModelKind::sensor;
  std::string name, reference, sha256;
  SensorSpec sensor{};           ///< sensor with its modules
  DescribedObserver observer{};  ///< observer with its module
  EnhancementPackage package{};  ///< package; without stages if there is no package
  std::vector<std::string> provenance{};
};
/// Reads a model by name or file. A file with [[stage]] is a package, a file with blur_sigma_samples is an observer,
/// and any other file is a sensor. "none" is a package without stages. Errors: `invalid_input`, as from the readers of
/// each kind.
[[nodiscard]] Result<ComparedModel> read_compared_model(const std::string& reference);

/// A key of the two descriptions with different values, as text.
struct KeyDifference {
  std::string key, a, b;
};
/// Difference B minus A over the whole picture, or the reason for its absence.
struct PixelDifference {
  std::string what;
  std::optional<double> mean_k, rms_k, largest_k;  ///< largest by magnitude, with its sign
  cv::Point largest_at{};
  std::string reason;
};
/// Modulus of the transfer functions along x; for observers, the modulus of their blur. Absent if a model is a program.
struct TransferPoint {
  double frequency_per_mrad = 0;
  double a = 0, b = 0;
};
/// Result of the comparison.
struct ModelComparison {
  ComparedModel a, b;
  std::vector<KeyDifference> keys;
  std::vector<PixelDifference> pixels;
  std::vector<TransferPoint> transfer;
  std::optional<double> parts_at_per_mrad;  ///< lowest frequency at which the moduli differ by more than 0.01
  PackageResult result_a, result_b;
  std::vector<PairedRatio> ratios;  ///< acuity of B divided by the acuity of A
  std::vector<std::string> notes;
};

/// Simulates the plan with both models, with every effect, the seed of the plan and the same presentations. Errors:
/// `invalid_input` for models of different kinds, for a plan with modules or an adaptive schedule; those of the
/// simulation of A or B. An error of a module is part of its result.
[[nodiscard]] Result<ModelComparison> compare_models(const LoadedPlan& plan, ComparedModel a, ComparedModel b,
                                                     const EnhancementOptions& options, std::stop_token stop);

/// Returns whether the models differ: the paired interval excludes 1. Empty if there is no interval.
[[nodiscard]] std::optional<bool> parts(const PairedRatio& ratio);

}  // namespace todbench
