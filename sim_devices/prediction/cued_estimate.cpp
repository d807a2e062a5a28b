// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/prediction/cued_estimate.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "acquisition/base/try.h"
#include "hvs/shape/polygon_spectrum.h"
#include "sim_devices/sensor/transfer_functions.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

constexpr double size_step = 1.08;
constexpr int smallest_index = -20, first_index = 9, largest_index = 48;
constexpr int quadrature_nodes = 16;  // 1e-3 of probability at worst: 0.1 % of size

double logit(double p) {
  const double inside = std::clamp(p, 0.25 + 1e-6, 1 - 1e-6);
  return std::log((inside - 0.25) / (1 - inside));
}

/// Noise, from `q` downwards, at which a size is judged 75 % correct, to 2 %.
double bearable_noise(const SizeTrial& trial, double q) {
  double high = q, low = q;
  do {
    high = low;
    low /= 4;
  } while (low > 1e-4 * q && logit(trial.known_position_proportion(low, quadrature_nodes)) < std::numbers::ln2);
  while (high / low > 1.02) {
    const double middle = std::sqrt(low * high);
    (logit(trial.known_position_proportion(middle, quadrature_nodes)) < std::numbers::ln2 ? high : low) = middle;
  }
  return high;
}

Accuracy planning_accuracy() {
  Accuracy accuracy = Accuracy::normal();
  accuracy.wavelengths = 4;
  accuracy.phases_per_axis = 4;
  return accuracy;
}

}  // namespace

CuedEstimate::CuedEstimate(const SensorSpec& sensor, const SensorPlan& plan, TemplateObserver& observer,
                           SceneMotion motion)
    : observer_(observer),
      chain_(sensor, plan, planning_accuracy(), motion),
      conditions_{.sensor = as_planned(sensor, plan),
                  .motion = motion,
                  .samples_per_pitch = as_planned(sensor, plan).samples_per_pitch(),
                  .phases_per_axis = planning_accuracy().phases_per_axis,
                  .search_step_samples = observer.spec().search_step_samples} {}

Result<const SizeTrial*> CuedEstimate::trial_at(int index) {
  auto& slot = trials_[index];
  if (slot == nullptr) {
    TODBENCH_TRY_VOID(check_sample_shape(conditions_.sensor, observer_.spec()));
    const double size = std::pow(size_step, index);
    TODBENCH_TRY(auto bank, observer_.bank(size * conditions_.samples_per_pitch, conditions_.samples_per_pitch));
    slot = std::make_unique<SizeTrial>(chain_, bank, size, conditions_, RandomStream(1, "unused"));
  }
  return slot.get();
}

Result<const SizeTrial*> CuedEstimate::trial(double size_pitch) {
  return trial_at(std::clamp(static_cast<int>(std::lround(std::log(size_pitch) / std::log(size_step))), smallest_index,
                             largest_index));
}

double CuedEstimate::proportion(const SizeTrial& trial, double q) const {
  const double eye_sd = contrast_k_ != 0 ? eye_scale_ * trial.eye_sd(contrast_k_) : 0;
  return trial.known_position_proportion(q, quadrature_nodes, eye_sd);
}

bool CuedEstimate::hopeless(double q, int index) {
  // The noise of an eye falls with the size, so that the power below is no bound.
  if (observer_.spec().eye) return false;
  // The response to the differences of the shapes, and with it the tolerable noise, grows with a power of the size. The
  // power is high as long as blur and footprint remove most of the differences, and falls to 1. The power between two
  // sizes is therefore a bound for larger sizes; a tenth is added because there are few phases.
  constexpr double margin = 1.1;
  const auto here = trial_at(index), before = trial_at(index - 4);
  if (!here || !before) return false;
  const double bearable = bearable_noise(**here, q);
  const double power = std::max(1.0, std::log(bearable / bearable_noise(**before, q)) / (4 * std::log(size_step)));
  return q > margin * bearable * std::pow(size_step, power * (largest_index - index));
}

Result<double> CuedEstimate::s75_pitch(double q) {
  std::map<int, double> known;
  std::optional<Error> error;
  const auto at = [&](int index) {
    if (const auto found = known.find(index); found != known.end()) return found->second;
    const auto t = trial_at(index);
    if (!t) error = t.error();
    return known[index] = t ? logit(proportion(**t, q)) : 0;
  };
  const double target = std::numbers::ln2;  // logit(0.75)
  int above = first_index;
  while (!error && at(above) < target) {
    if (above >= largest_index)
      return fail(ErrorCode::invalid_input, "no size up to 40 pitches reaches 75 % correct answers");
    // Large sizes take long: stop if the proportion is near chance and must stay below 75 %.
    if (above > first_index && at(above) < logit(0.4) && hopeless(q, above))
      return fail(ErrorCode::invalid_input, "no size up to 40 pitches reaches 75 % correct answers");
    above = std::min(above + 4, largest_index);
  }
  int below = above - 1;
  while (!error && at(below) >= target) {
    if (below <= smallest_index) return fail(ErrorCode::invalid_input, "even the smallest target is recognised");
    --below;
  }
  if (error) return tl::unexpected(*error);
  const double share = (target - at(below)) / (at(below + 1) - at(below));
  return std::pow(size_step, below + share);
}

Result<double> CuedEstimate::sensitivity(double q) {
  // A fifth to each side: several sizes of the ladder, so that its interpolation has no effect.
  eye_scale_ = 1.2;
  const auto more = s75_pitch(q * 1.2);
  eye_scale_ = 1 / 1.2;
  const auto less = more ? s75_pitch(q / 1.2) : more;
  eye_scale_ = 1;
  if (!more) return more;
  if (!less) return less;
  return std::log(*more / *less) / (2 * std::log(1.2));
}

Result<double> CuedEstimate::weibull_slope(double q) {
  const auto size = s75_pitch(q);
  if (!size) return size;
  const int middle = static_cast<int>(std::lround(std::log(*size) / std::log(size_step)));
  const int below = std::max(middle - 2, smallest_index), above = std::min(middle + 2, largest_index);
  double logits[2];
  for (int i = 0; i < 2; ++i) {
    TODBENCH_TRY(const auto trial, trial_at(i == 0 ? below : above));
    logits[i] = logit(proportion(*trial, q));
  }
  // dlogit/dP at 3/4 is 1/(1/2) + 1/(1/4) = 6.
  const double rise = (logits[1] - logits[0]) / ((above - below) * std::log(size_step)) / 6;
  return 4 * rise / std::log(3.0);
}

double discriminability(const SensorSpec& sensor, const SensorPlan& plan, double size_pitch, int wavelengths,
                        SceneMotion motion) {
  const int period = 2 * static_cast<int>(std::ceil(2 * size_pitch)) + 8;
  double highest = 8;  // higher frequencies carry less than 1 % of the differences of triangles of a pitch
  if (plan.simulates(Effect::diffraction))
    highest = std::min(highest, sensor.pitch_um / (sensor.wavelength_min_um * sensor.f_number));
  const FrequencyLattice lattice{.period = period, .band = static_cast<int>(highest * period)};
  const auto up = polygon_spectrum(triangle(size_pitch, Apex::up), lattice);
  const auto right = polygon_spectrum(triangle(size_pitch, Apex::right), lattice);
  const auto down = polygon_spectrum(triangle(size_pitch, Apex::down), lattice);
  const TransferFunction transfer = sensor_transfer(sensor, plan, wavelengths, motion);
  double sum = 0;
  for (int r = 0; r < up.rows; ++r) {
    for (int c = 0; c < up.cols; ++c) {
      const double difference = std::norm(up(r, c) - down(r, c)) + std::norm(up(r, c) - right(r, c));
      const double u = static_cast<double>(c) / period, w = static_cast<double>(r - lattice.band) / period;
      sum += difference * std::norm(transfer(u, w * sensor.pitch_aspect()));
    }
  }
  return std::sqrt(sum) / period;
}

}  // namespace todbench
