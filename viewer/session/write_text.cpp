#include "viewer/session/write_text.h"

#include <cerrno>
#include <fstream>
#include <string>
#include <system_error>

#include <unistd.h>

namespace armature::viewer {

std::string file_name(const std::filesystem::path& path) {
  return path.has_filename() ? path.filename().string() : path.string();
}

sdk::Expected<void> write_text(const std::filesystem::path& path, std::string_view text) {
  const std::filesystem::path unfinished = path.string() + ".part." + std::to_string(getpid());
  errno = 0;
  std::ofstream out(unfinished, std::ios::binary);
  out << text;
  out.close();
  std::error_code error(out ? 0 : errno, std::generic_category());
  if (out) std::filesystem::rename(unfinished, path, error);
  if (out && !error) return {};
  std::error_code ignored;
  std::filesystem::remove(unfinished, ignored);
  return sdk::fail(path.string() + ": cannot be written" + (error ? ": " + error.message() : ""));
}

}  // namespace armature::viewer
