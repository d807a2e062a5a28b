// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/module/module_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "acquisition/base/rng.h"
#include "acquisition/base/try.h"

namespace todbench {
namespace {

cv::Mat1f noise(cv::Size size, std::uint64_t index) {
  cv::Mat1f picture(size);
  RandomStream(1, "module.check").sub(index).fill_normal({picture.ptr<float>(), picture.total()});
  return picture;
}

/// Answers of a new process to the pictures, in order.
Result<std::vector<cv::Mat1f>> answers_to(const ModuleOptions& options, const std::vector<cv::Mat1f>& pictures) {
  TODBENCH_TRY(auto module, ModuleProcess::start(options));
  std::vector<cv::Mat1f> answers;
  for (const auto& picture : pictures) {
    auto answer = module.exchange(picture);
    if (!answer)
      return fail(
          fmt::format("picture {} of {}, {} x {}", answers.size() + 1, pictures.size(), picture.cols, picture.rows),
          answer.error());
    answers.push_back(*answer);
  }
  return answers;
}

/// Median of twenty exchanges with the same picture.
Result<double> latency_ms(const ModuleOptions& options) {
  TODBENCH_TRY(auto module, ModuleProcess::start(options));
  const cv::Mat1f picture = noise({320, 240}, 9);
  std::vector<double> times;
  for (int i = 0; i < 21; ++i) {
    const auto begin = std::chrono::steady_clock::now();
    TODBENCH_TRY_VOID(module.exchange(picture));
    times.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count());
  }
  std::nth_element(times.begin() + 1, times.begin() + 11, times.end());  // the first includes the start
  return times[11];
}

/// Answer of a separate process, which has no memory of earlier pictures.
Result<cv::Mat1f> fresh_answer(const ModuleOptions& options, const cv::Mat1f& picture) {
  TODBENCH_TRY(auto answers, answers_to(options, {picture}));
  return answers.front();
}

double largest(const cv::Mat1f& picture) {
  return cv::norm(picture, cv::NORM_INF);
}

}  // namespace

Result<ModuleReport> check_module(const ModuleOptions& options) {
  ModuleReport report;
  report.network_cut = options.network == ModuleNetwork::cut && can_cut_network();
  constexpr int side = 33;
  const std::vector<cv::Mat1f> pictures{noise({32, 24}, 1), noise({24, 32}, 2), noise({1, 1}, 3), noise({160, 120}, 4)};
  const auto first = answers_to(options, pictures), second = answers_to(options, pictures);
  if (!first) return tl::unexpected(first.error());
  if (!second) return tl::unexpected(second.error());
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    if (cv::norm((*first)[i], (*second)[i], cv::NORM_INF) != 0)
      return fail(ErrorCode::integrity, "two processes of the module answered the same pictures differently");
    report.shapes.push_back(pictures[i].size());
  }
  TODBENCH_TRY(report.latency_ms, latency_ms(options));
  const cv::Mat1f a = noise({side, side}, 5), b = noise({side, side}, 6), zero = cv::Mat1f::zeros(side, side);
  cv::Mat1f impulse = zero.clone();
  impulse(side / 2, side / 2) = 1;
  std::vector<cv::Mat1f> answers;
  for (const auto& picture : {zero, a, b, cv::Mat1f(2 * a - 0.5 * b), impulse}) {
    TODBENCH_TRY(auto answer, fresh_answer(options, picture));
    answers.push_back(answer - (answers.empty() ? cv::Mat1f(zero) : answers.front()));
  }
  const double scale = std::max({largest(answers[1]), largest(answers[2]), 1e-12});
  report.linearity_deviation = largest(answers[3] - (2 * answers[1] - 0.5 * answers[2])) / scale;
  report.linear = report.linearity_deviation < 1e-4;
  report.impulse_response = answers[4](cv::Rect(side / 2 - 4, side / 2 - 4, 9, 9)).clone();
  report.impulse_sum = cv::sum(answers[4])[0];
  return report;
}

}  // namespace todbench
