#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "firmware_host/error.h"

namespace armature {

/// A regular file, read at any offset. Its size is the one it had when it was opened; a file that shrinks meanwhile
/// makes reads fail, never the process.
class FileReader {
 public:
  /// Fails with one line when the file is missing, unreadable or not a regular file.
  [[nodiscard]] static Expected<FileReader> open(const std::filesystem::path& path);

  FileReader(FileReader&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)), size_(other.size_) {}
  FileReader& operator=(FileReader&& other) noexcept {
    std::swap(descriptor_, other.descriptor_);
    std::swap(size_, other.size_);
    return *this;
  }
  ~FileReader();

  [[nodiscard]] std::uint64_t size() const noexcept { return size_; }
  /// The file's size now.
  [[nodiscard]] std::uint64_t current_size() const noexcept;
  /// A name under which this process can open the same file again, whatever happens to the name it was opened by.
  [[nodiscard]] std::string path_of_descriptor() const { return "/proc/self/fd/" + std::to_string(descriptor_); }
  /// Fills `out`; false when the bytes are not all there.
  [[nodiscard]] bool read_at(std::uint64_t offset, std::span<std::byte> out) const noexcept;

 private:
  FileReader(int descriptor, std::uint64_t size) : descriptor_(descriptor), size_(size) {}

  int descriptor_;
  std::uint64_t size_;
};

/// A whole file of at most `max_bytes`.
[[nodiscard]] Expected<std::vector<std::byte>> read_file(const std::filesystem::path& path, std::uint64_t max_bytes);

}  // namespace armature
