#include "firmware_host/recording/file_reader.h"

#include <cerrno>
#include <cstring>
#include <string>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace armature {

Expected<FileReader> FileReader::open(const std::filesystem::path& path) {
  // O_NONBLOCK: opening a pipe must not wait for its writer.
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) return fail(path.string() + ": cannot be opened: " + std::strerror(errno));
  FileReader file(descriptor, 0);
  struct stat facts {};
  if (::fstat(descriptor, &facts) != 0) return fail(path.string() + ": cannot be read: " + std::strerror(errno));
  if (!S_ISREG(facts.st_mode)) return fail(path.string() + ": not a regular file");
  file.size_ = static_cast<std::uint64_t>(facts.st_size);
  return file;
}

FileReader::~FileReader() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

std::uint64_t FileReader::current_size() const noexcept {
  struct stat facts {};
  return ::fstat(descriptor_, &facts) == 0 ? static_cast<std::uint64_t>(facts.st_size) : 0;
}

bool FileReader::read_at(std::uint64_t offset, std::span<std::byte> out) const noexcept {
  while (!out.empty()) {
    const auto count = ::pread(descriptor_, out.data(), out.size(), static_cast<off_t>(offset));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    out = out.subspan(static_cast<std::size_t>(count));
    offset += static_cast<std::uint64_t>(count);
  }
  return true;
}

Expected<std::vector<std::byte>> read_file(const std::filesystem::path& path, std::uint64_t max_bytes) {
  auto file = FileReader::open(path);
  if (!file) return tl::unexpected(file.error());
  if (file->size() > max_bytes)
    return fail(path.string() + ": " + std::to_string(file->size()) + " bytes: expected at most " +
                std::to_string(max_bytes));
  std::vector<std::byte> bytes(file->size());
  if (!file->read_at(0, bytes)) return fail(path.string() + ": cannot be read: " + std::strerror(errno));
  return bytes;
}

}  // namespace armature
