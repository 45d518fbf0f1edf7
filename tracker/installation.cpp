#include "tracker/installation.h"

namespace armature {
namespace {

std::filesystem::path prefix() {
  std::error_code error;
  return std::filesystem::read_symlink("/proc/self/exe", error).parent_path() / "..";
}

}  // namespace

std::filesystem::path installed_file(std::string_view name) {
  return (prefix() / "share" / "armature" / name).lexically_normal();
}

std::filesystem::path installed_plugin(std::string_view name) {
  return (prefix() / "lib" / "armature" / name).lexically_normal();
}

}  // namespace armature
