// Two models against each other: sensors, observers, or packages of stages, before the same scenes with the same seeds.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bench/enhance/enhancement.h"
#include "bench/plan/descriptions.h"

namespace todbench {

/// What is compared; both sides are of one kind.
enum class ModelKind { sensor, observer, package };
[[nodiscard]] std::string_view to_string(ModelKind kind);

/// One side. Only what belongs to its kind says anything.
struct ComparedModel {
  ModelKind kind = ModelKind::sensor;
  std::string name, reference, sha256;
  SensorSpec sensor{};           ///< with its modules
  DescribedObserver observer{};  ///< with its module
  EnhancementPackage package{};  ///< without stages: none
  std::vector<std::string> provenance{};
};
/// By name or file; a file with [[stage]] is a package, one with blur_sigma_samples an observer, any other a sensor;
/// "none" is a package without stages. `invalid_input` as those readers.
[[nodiscard]] Result<ComparedModel> read_compared_model(const std::string& reference);

/// A key of the two descriptions with different values, as text.
struct KeyDifference {
  std::string key, a, b;
};
/// B less A over the whole picture, or why there is none.
struct PixelDifference {
  std::string what;
  std::optional<double> mean_k, rms_k, largest_k;  ///< largest by magnitude, with its sign
  cv::Point largest_at{};
  std::string reason;
};
/// Modulus along x. Of observers it is that of their blur; there is none where one of them is a program.
struct TransferPoint {
  double frequency_per_mrad = 0;
  double a = 0, b = 0;
};
struct ModelComparison {
  ComparedModel a, b;
  std::vector<KeyDifference> keys;
  std::vector<PixelDifference> pixels;
  std::vector<TransferPoint> transfer;
  std::optional<double> parts_at_per_mrad;  ///< lowest frequency at which the moduli differ by more than 0.01
  PackageResult result_a, result_b;
  std::vector<PairedRatio> ratios;  ///< acuity of B over that of A
  std::vector<std::string> notes;
};

/// Simulates the plan with both: every effect, the seed of the plan, the same presentations. Errors: `invalid_input`
/// for two kinds, for a plan with modules or an adaptive schedule; those of the simulation of A or B, except that of a
/// module, which is in its result.
[[nodiscard]] Result<ModelComparison> compare_models(const LoadedPlan& plan, ComparedModel a, ComparedModel b,
                                                     const EnhancementOptions& options, std::stop_token stop);

/// Whether the paired interval leaves out 1; nothing where there is none.
[[nodiscard]] std::optional<bool> parts(const PairedRatio& ratio);

}  // namespace todbench
