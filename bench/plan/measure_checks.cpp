// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/plan/measure_checks.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "bench/text/text.h"

namespace todbench {

ValueMistakes check_transfer_steps(const Plan& plan, std::size_t /*row*/) {
  std::vector<double> steps = plan.measures.transfer_steps_k;
  std::sort(steps.begin(), steps.end());
  steps.erase(std::unique(steps.begin(), steps.end()), steps.end());
  if (steps.size() >= 3) return {};
  return {{std::nullopt, "expected at least three different steps, found " + std::to_string(steps.size())}};
}

ValueMistakes check_pixels(const Plan& plan, std::size_t /*row*/) {
  constexpr int least_frames = 48;
  if (!plan.measures.pixels) return {};
  if (!plan.measures.noise)
    return {{std::nullopt, "the pixel search needs noise = true, because it uses the noise cube"}};
  if (plan.measures.noise_frames >= least_frames) return {};
  return {{std::nullopt, "the pixel search needs noise_frames of at least " + std::to_string(least_frames) +
                             ", found " + std::to_string(plan.measures.noise_frames)}};
}

ValueMistakes check_mtf_contrast(const Plan& plan, std::size_t /*row*/) {
  if (!plan.measures.mtf || plan.measures.mtf_delta_t_k != 0) return {};
  return {{std::nullopt, "the MTF needs a contrast other than 0"}};
}

ValueMistakes check_ctf_contrast(const Plan& plan, std::size_t /*row*/) {
  if (!plan.measures.ctf || plan.measures.ctf_delta_t_k != 0) return {};
  return {{std::nullopt, "the CTF needs a contrast other than 0"}};
}

ValueMistakes check_source_size_contrast(const Plan& plan, std::size_t /*row*/) {
  if (!plan.measures.source_size || plan.measures.source_size_delta_t_k != 0) return {};
  return {{std::nullopt, "the size-of-source effect needs a contrast other than 0"}};
}

ValueMistakes check_absolute_temperatures(const Plan& plan, std::size_t /*row*/) {
  if (!plan.measures.absolute) return {};
  const std::vector<double>& temperatures = plan.measures.absolute_temperatures_k;
  ValueMistakes mistakes;
  constexpr std::size_t least = 3;
  if (temperatures.size() < least)
    mistakes.push_back({std::nullopt, "expected at least three temperatures, found " +
                                          number_text(static_cast<double>(temperatures.size()))});
  for (std::size_t i = 1; i < temperatures.size(); ++i) {
    if (!(temperatures[i] > temperatures[i - 1]))
      mistakes.push_back({i, "temperatures must rise: expected more than " + number_text(temperatures[i - 1]) +
                                 " K, found " + number_text(temperatures[i]) + " K"});
  }
  if (plan.target.kind != TargetKind::scpi)
    mistakes.push_back({std::nullopt,
                        "absolute temperatures need a black body with an absolute set-point: [target] kind must be "
                        "\"scpi\""});
  return mistakes;
}

ValueMistakes check_mrtd(const Plan& plan, std::size_t /*row*/) {
  if (!plan.measures.mrtd || plan.target.kind != TargetKind::display) return {};
  return {{std::nullopt, "the MRTD needs contrasts far below a grey level of a monitor: use a black body"}};
}

ValueMistakes check_mrtd_contrasts(const Plan& plan, std::size_t /*row*/) {
  if (!plan.measures.mrtd) return {};
  std::vector<double> contrasts = plan.measures.mrtd_delta_t_k;
  std::sort(contrasts.begin(), contrasts.end());
  contrasts.erase(std::unique(contrasts.begin(), contrasts.end()), contrasts.end());
  if (contrasts.size() < 3 || contrasts.size() != plan.measures.mrtd_delta_t_k.size())
    return {{std::nullopt, "expected at least three contrasts, each stated once"}};
  return {};
}

ValueMistakes check_response(const Plan& plan, std::size_t /*row*/) {
  const bool settling = plan.measures.gain_control;
  if (!plan.measures.response && !settling) return {};
  ValueMistakes mistakes;
  if (plan.measures.response_delta_t_k == 0)
    mistakes.push_back({std::nullopt, "the response time needs a contrast other than 0"});
  if (settling && plan.target.kind != TargetKind::scene && !plan.measures.response_settling_ms)
    mistakes.push_back(
        {std::nullopt, "the settling of the gain needs response_settling_ms: a slow step of the target hides it"});
  if (plan.measures.response && plan.target.kind != TargetKind::scene && !plan.measures.response_settling_ms)
    mistakes.push_back(
        {std::nullopt,
         "the response time needs response_settling_ms: a slow step of the target hides the response of the camera"});
  return mistakes;
}

}  // namespace todbench
