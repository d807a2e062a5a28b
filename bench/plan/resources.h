// SPDX-License-Identifier: GPL-3.0-or-later
// Plates, sensors, observers, plans, air tables and other descriptions, by name (compiled in) or by file.
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/base/result.h"

namespace todbench {

/// Kind of description.
enum class ResourceKind {
  plate,
  sensor,
  observer,
  plan,
  atmosphere,
  scene,
  target,
  target_set,
  black_body,
  stage,
  letterhead
};
/// Returns the kind in words.
[[nodiscard]] std::string_view to_string(ResourceKind kind);

/// Compiled-in file. The name has no folder and no extension.
struct EmbeddedResource {
  ResourceKind kind;
  std::string_view name;
  std::string_view text;
};
/// Returns all compiled-in files, sorted by kind and name. The build generates them from tod/plate,
/// sim_devices/sensors, hvs/observers, bench/plans, sim_devices/atmosphere, sim_devices/scenes, sim_devices/targets,
/// sim_devices/target_sets, tod/instruments/black_bodies and tod/instruments/stages.
[[nodiscard]] std::span<const EmbeddedResource> embedded_resources();

/// Text of a description and its name for messages.
struct Resource {
  std::string origin;  ///< path of the file, or "NAME (built in)"
  std::string text;
};

/// Returns the names of the compiled-in resources of a kind, sorted.
[[nodiscard]] std::vector<std::string> resource_names(ResourceKind kind);
/// Returns whether the reference is a file (it has a slash or ends in ".toml") and not a name.
[[nodiscard]] bool is_file_reference(std::string_view reference);
/// Returns the path of a file reference that appears in a file of `folder`; names are returned unchanged.
[[nodiscard]] std::string absolute_reference(std::string_view reference, const std::filesystem::path& folder);
/// Finds a resource; relative files are relative to the current folder. Errors: `invalid_input` (unknown name: the
/// message lists the known names and the nearest; unreadable file).
[[nodiscard]] Result<Resource> find_resource(ResourceKind kind, std::string_view reference);
/// Finder of resources: find_resource() or its replacement.
using ResourceFinder = std::function<Result<Resource>(ResourceKind kind, std::string_view reference)>;

}  // namespace todbench
