#include "tools/output_file.h"

#include <cerrno>
#include <cstdio>
#include <cstring>

#include <unistd.h>

namespace armature::tools {

Expected<void> write_file(const std::string& path, std::string_view content) {
  const std::string temporary = path + ".part." + std::to_string(getpid());
  const auto failed = [&](const char* what) {
    const std::string message = path + ": " + what + ": " + std::strerror(errno);
    std::remove(temporary.c_str());
    return fail(message);
  };
  std::FILE* file = std::fopen(temporary.c_str(), "wb");
  if (file == nullptr) return failed("cannot be written");
  const bool written = std::fwrite(content.data(), 1, content.size(), file) == content.size();
  if (std::fclose(file) != 0 || !written) return failed("cannot be written");
  if (std::rename(temporary.c_str(), path.c_str()) != 0) return failed("cannot be replaced");
  return {};
}

}  // namespace armature::tools
