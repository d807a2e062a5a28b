// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/plan/resources.h"

#include "acquisition/base/try.h"
#include "bench/text/text.h"

namespace todbench {

std::string_view to_string(ResourceKind kind) {
  switch (kind) {
    case ResourceKind::plate:
      return "plate";
    case ResourceKind::sensor:
      return "sensor";
    case ResourceKind::observer:
      return "observer";
    case ResourceKind::plan:
      return "plan";
    case ResourceKind::atmosphere:
      return "atmosphere";
    case ResourceKind::scene:
      return "scene";
    case ResourceKind::target:
      return "target";
    case ResourceKind::target_set:
      return "set of targets";
    case ResourceKind::black_body:
      return "blackbody";
    case ResourceKind::stage:
      return "stage";
    case ResourceKind::letterhead:
      return "letterhead";
  }
  return "";
}

std::vector<std::string> resource_names(ResourceKind kind) {
  std::vector<std::string> names;
  for (const EmbeddedResource& resource : embedded_resources()) {
    if (resource.kind == kind) names.emplace_back(resource.name);
  }
  return names;
}

bool is_file_reference(std::string_view reference) {
  return reference.find('/') != std::string_view::npos || reference.ends_with(".toml");
}

std::string absolute_reference(std::string_view reference, const std::filesystem::path& folder) {
  if (!is_file_reference(reference)) return std::string(reference);
  std::error_code problem;
  const std::filesystem::path path = std::filesystem::absolute(folder / reference, problem);
  return problem ? std::string(reference) : path.lexically_normal().string();
}

Result<Resource> find_resource(ResourceKind kind, std::string_view reference) {
  if (is_file_reference(reference)) {
    TODBENCH_TRY(std::string text, read_text_file(std::filesystem::path(reference)));
    return Resource{std::string(reference), std::move(text)};
  }
  for (const EmbeddedResource& resource : embedded_resources()) {
    if (resource.kind != kind || resource.name != reference) continue;
    return Resource{std::string(reference) + " (built in)", std::string(resource.text)};
  }
  const std::vector<std::string> names = resource_names(kind);
  if (names.empty())
    return fail(ErrorCode::invalid_input, "'" + one_line(reference) + "': the file of a " +
                                              std::string(to_string(kind)) + " needs a slash or the ending .toml");
  return fail(ErrorCode::invalid_input, "unknown " + std::string(to_string(kind)) + " '" + one_line(reference) + "'" +
                                            nearest_name_hint(reference, names) + " (known: " + quoted_list(names) +
                                            "; a file needs a slash or the ending .toml)");
}

}  // namespace todbench
