#include "tracker/installation.h"

namespace armature {

std::filesystem::path installed_file(std::string_view name) {
  std::error_code error;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", error);
  return (program.parent_path() / ".." / "share" / "armature" / name).lexically_normal();
}

}  // namespace armature
