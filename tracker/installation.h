#pragma once

#include <filesystem>
#include <string_view>

namespace armature {

/// A file of share/armature, found beside the running program: an installation and a build tree have the same shape
/// (bin/PROGRAM and share/armature/FILE).
[[nodiscard]] std::filesystem::path installed_file(std::string_view name);

/// A plug-in of lib/armature, found the same way.
[[nodiscard]] std::filesystem::path installed_plugin(std::string_view name);

/// The forest that comes with Armature.
[[nodiscard]] inline std::filesystem::path installed_model() {
  return installed_file("person.forest");
}

}  // namespace armature
