#include "sdk/io/file_bytes.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <memory>
#include <system_error>

#include <unistd.h>

namespace armature::sdk {
namespace {

struct Close {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

std::string reason(int error) {
  return std::generic_category().message(error);
}

}  // namespace

Expected<void> check_readable(const std::filesystem::path& path) {
  const std::unique_ptr<std::FILE, Close> file(std::fopen(path.c_str(), "rb"));
  if (!file) return fail(path.string() + ": cannot be read: " + reason(errno));
  return {};
}

Expected<std::string> read_file_bytes(const std::filesystem::path& path, std::size_t most) {
  const std::unique_ptr<std::FILE, Close> file(std::fopen(path.c_str(), "rb"));
  if (!file) return fail(path.string() + ": cannot be read: " + reason(errno));
  std::error_code ignored;
  const auto size = std::filesystem::file_size(path, ignored);
  std::string bytes;
  constexpr std::size_t kChunk = 1U << 20U;
  // One byte more than there should be, so that the end is seen without growing.
  std::size_t room = std::min(most, ignored ? kChunk : static_cast<std::size_t>(size) + 1);
  for (std::size_t got = room; got == room && bytes.size() < most; room = std::min(kChunk, most - bytes.size())) {
    const std::size_t had = bytes.size();
    bytes.resize(had + room);
    errno = 0;
    got = std::fread(bytes.data() + had, 1, room, file.get());
    bytes.resize(had + got);
  }
  if (std::ferror(file.get()) != 0) return fail(path.string() + ": cannot be read: " + reason(errno));
  return bytes;
}

Expected<void> write_file_bytes(const std::filesystem::path& path, std::string_view bytes) {
  const std::string temporary = path.string() + ".part." + std::to_string(getpid());
  const auto failed = [&] {
    const std::string message = path.string() + ": cannot be written: " + reason(errno);
    std::remove(temporary.c_str());
    return fail(message);
  };
  std::FILE* file = std::fopen(temporary.c_str(), "wb");
  if (file == nullptr) return failed();
  const bool written = std::fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size();
  if (std::fclose(file) != 0 || !written) return failed();
  if (std::rename(temporary.c_str(), path.c_str()) != 0) return failed();
  return {};
}

}  // namespace armature::sdk
