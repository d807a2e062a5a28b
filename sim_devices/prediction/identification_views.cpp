// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/prediction/identification_views.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <optional>
#include <string>

#include "sim_devices/sensor/effect_readout.h"

namespace todbench {
namespace {

bool look_alike(const std::vector<SeenAspect>& a, const std::vector<SeenAspect>& b) {
  const auto same = [](const StepEdge& p, const StepEdge& q) {
    return cv::norm(p.a - q.a) < 1e-6 && cv::norm(p.b - q.b) < 1e-6 && std::abs(p.step - q.step) < 1e-9;
  };
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [&](const SeenAspect& s, const SeenAspect& t) {
    return std::equal(s.edges_m.begin(), s.edges_m.end(), t.edges_m.begin(), t.edges_m.end(), same);
  });
}

/// Scales all targets to the mean size.
void make_alike_in_size(SeenTargets& targets) {
  double sum = 0, count = 0;
  for (const auto& target : targets) {
    for (const auto& aspect : target) {
      sum += aspect.size_m;
      ++count;
    }
  }
  for (auto& target : targets) {
    for (auto& aspect : target) aspect.edges_m = placed(aspect.edges_m, sum / count / aspect.size_m, 0, {0, 0});
  }
}

/// Edges of a view in metres, at uniform level if one is stated. Of a picture, those of the elements of the target.
std::vector<StepEdge> edges_of(const FieldScene& scene, const RadianceScale& scale, std::optional<double> uniform_k) {
  if (scene.picture) {
    const ScenePicture& picture = *scene.picture;
    cv::Mat1d levels = uniform_k ? cv::Mat1d(picture.kelvin.size(), *uniform_k) : picture_levels_k(scene, scale);
    levels.setTo(0, picture.target == 0);
    return element_edges(levels, picture.element_m, cv::Point2d(levels.cols, levels.rows) * (-0.5 * picture.element_m));
  }
  auto painted = levels_k(scene, scale);
  if (uniform_k) {
    for (auto& region : painted) region.level = *uniform_k;
  }
  return visible_edges(painted);
}

}  // namespace

Result<SeenTargets> seen_targets(const IdentificationTask& task) {
  const RadianceScale scale{{task.sensor.wavelength_min_um, task.sensor.wavelength_max_um},
                            task.sensor.scene_temperature_k};
  SeenTargets out;
  for (const auto& target : task.targets) {
    if (target.aspects.empty() || target.aspects.size() != task.targets.front().aspects.size())
      return fail(ErrorCode::invalid_input, "every target must have the same number of aspects, at least one");
    if (target.aspects.size() > most_aspects)
      return fail(ErrorCode::invalid_input, "a target has at most " + std::to_string(most_aspects) + " aspects");
  }
  for (const auto& target : task.targets) {
    auto& own = out.emplace_back();
    for (const auto& scene : target.aspects) {
      if (auto fine = validate(scene); !fine) return fail("target " + target.name, fine.error());
      const auto signature = target_signature(scene, scale);
      if (!signature || !(signature->dt_rss_k() > 0))
        return fail(ErrorCode::invalid_input, "target " + target.name + " has no contrast against its background");
      const auto uniform_k = task.cues == TargetCues::shape ? std::optional(signature->dt_rss_k()) : std::nullopt;
      own.push_back({edges_of(scene, scale, uniform_k), signature->dt_rss_k(), signature->size_m()});
    }
  }
  if (out.size() < 2) return fail(ErrorCode::invalid_input, "identification needs at least two targets");
  if (task.cues == TargetCues::shape) make_alike_in_size(out);
  for (std::size_t i = 0; i < out.size(); ++i) {
    for (std::size_t other = 0; other < i; ++other) {
      if (look_alike(out[other], out[i])) {
        return fail(ErrorCode::invalid_input, "targets " + task.targets[other].name + " and " + task.targets[i].name +
                                                  " look alike in every aspect, so no observer can distinguish them");
      }
    }
  }
  return out;
}

std::size_t first_draw_of(std::size_t phase, std::size_t target, std::size_t aspect) {
  return (phase + target + 5 * aspect) % identification_phases;
}

cv::Point2d view_offset(std::size_t phase) {
  const auto offset = [](std::size_t k) {
    return (static_cast<double>(k) + 0.5) / identification_phases_on_axis - 0.5;
  };
  return {offset(phase % identification_phases_on_axis), offset(phase / identification_phases_on_axis)};
}

std::uint64_t presentation_of(std::size_t phase, std::size_t target, std::size_t aspect) {
  return phase + identification_phases * (aspect + most_aspects * target);
}

double samples_per_metre(const SensorSpec& spec, const IdentificationRange& range) {
  return 1e3 / (range.range_m * spec.ifov_mrad()) * spec.samples_per_pitch();
}

std::vector<AlternativeAspects> in_samples(const SeenTargets& targets, double samples_per_metre, const SensorSpec& spec,
                                           SceneMotion motion) {
  const cv::Point2d slope = readout_slope(spec, motion);
  std::vector<AlternativeAspects> alternatives;
  for (const auto& target : targets) {
    auto& own = alternatives.emplace_back();
    for (const auto& aspect : target) {
      auto& edges = own.emplace_back(placed(aspect.edges_m, samples_per_metre, 0, {0, 0}));
      for (auto& edge : edges) {
        edge.a = as_read_out(edge.a, slope, 0);
        edge.b = as_read_out(edge.b, slope, 0);
      }
    }
  }
  return alternatives;
}

}  // namespace todbench
