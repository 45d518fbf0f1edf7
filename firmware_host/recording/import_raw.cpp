#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>

#include <zstd.h>

#include "firmware_host/recording/import.h"

namespace armature {
namespace {

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
struct FreeStream {
  void operator()(ZSTD_DCtx* stream) const { ZSTD_freeDCtx(stream); }
};

class RawSource final : public DepthSource {
 public:
  RawSource(const std::filesystem::path& path, std::unique_ptr<std::FILE, CloseFile> file, const ImportOptions& options)
      : name_(path.string()), file_(std::move(file)) {
    info_.uri = "raw:" + path.filename().string();
    info_.intrinsics = options.intrinsics;
    info_.frames_per_second = options.frames_per_second;
    frame_bytes_ = std::size_t{2} * static_cast<std::size_t>(options.intrinsics.width) *
                   static_cast<std::size_t>(options.intrinsics.height);
    if (path.extension() == ".zst") {
      stream_.reset(ZSTD_createDCtx());
      compressed_.resize(ZSTD_DStreamInSize());
    }
    count_frames(path);
  }

  [[nodiscard]] const SourceInfo& info() const noexcept override { return info_; }

  Expected<ReadStatus> read(DepthFrame& frame, std::chrono::milliseconds) override {
    frame.depth_mm.resize(frame_bytes_ / 2);
    const auto filled = stream_ ? fill_decompressing(frame.depth_mm.data()) : fill(frame.depth_mm.data(), frame_bytes_);
    if (!filled) return tl::unexpected(filled.error());
    if (*filled == 0) return ReadStatus::EndOfStream;
    if (*filled != frame_bytes_)
      return fail(name_ + ": ends within frame " + std::to_string(next_) + ": expected a multiple of " +
                  std::to_string(frame_bytes_) + " bytes, " + std::to_string(info_.intrinsics.width) + " x " +
                  std::to_string(info_.intrinsics.height) + " pixels of two");
    frame.intrinsics = info_.intrinsics;
    frame.sequence = next_;
    const auto time = std::chrono::duration<double>(static_cast<double>(next_) / info_.frames_per_second);
    frame.sensor = {std::chrono::round<std::chrono::nanoseconds>(time), ClockId::Recording};
    ++next_;
    return ReadStatus::Frame;
  }

 private:
  void count_frames(const std::filesystem::path& path) {
    std::error_code error;
    unsigned long long bytes = std::filesystem::file_size(path, error);
    if (error) return;
    if (stream_) {
      input_.size = std::fread(compressed_.data(), 1, compressed_.size(), file_.get());
      input_.src = compressed_.data();
      bytes = ZSTD_getFrameContentSize(compressed_.data(), input_.size);
      if (bytes == ZSTD_CONTENTSIZE_UNKNOWN || bytes == ZSTD_CONTENTSIZE_ERROR) return;
    }
    info_.frame_count = static_cast<long>(bytes / frame_bytes_);
  }

  Expected<std::size_t> fill(void* out, std::size_t bytes) {
    const std::size_t count = std::fread(out, 1, bytes, file_.get());
    if (std::ferror(file_.get()) != 0) return fail(name_ + ": cannot be read: " + std::strerror(errno));
    return count;
  }

  Expected<std::size_t> fill_decompressing(void* out) {
    ZSTD_outBuffer output{out, frame_bytes_, 0};
    while (output.pos < output.size) {
      if (input_.pos == input_.size) {
        const auto count = fill(compressed_.data(), compressed_.size());
        if (!count) return tl::unexpected(count.error());
        if (*count == 0) {
          if (within_zstd_frame_) return fail(name_ + ": truncated: expected more compressed bytes");
          break;
        }
        input_ = {compressed_.data(), *count, 0};
      }
      const std::size_t result = ZSTD_decompressStream(stream_.get(), &output, &input_);
      if (ZSTD_isError(result) != 0U) return fail(name_ + ": not zstd: " + ZSTD_getErrorName(result));
      within_zstd_frame_ = result != 0;
    }
    return output.pos;
  }

  std::string name_;
  std::unique_ptr<std::FILE, CloseFile> file_;
  SourceInfo info_;
  std::size_t frame_bytes_ = 0;
  std::uint64_t next_ = 0;
  std::unique_ptr<ZSTD_DCtx, FreeStream> stream_;  // none: the file is not compressed
  std::vector<char> compressed_;
  ZSTD_inBuffer input_{nullptr, 0, 0};
  bool within_zstd_frame_ = false;
};

}  // namespace

Intrinsics nominal_intrinsics(int width, int height) noexcept {
  const double focal_px = 285.63 * width / 320;
  return {width, height, focal_px, focal_px, width / 2.0, height / 2.0};
}

Expected<std::unique_ptr<DepthSource>> open_raw_depth(const std::filesystem::path& path, const ImportOptions& options) {
  const Intrinsics& k = options.intrinsics;
  if (k.width < 1 || k.height < 1 || k.width > kMaxImageSide || k.height > kMaxImageSide)
    return fail(path.string() + ": resolution " + std::to_string(k.width) + " x " + std::to_string(k.height) +
                ": expected sides of 1 to " + std::to_string(kMaxImageSide));
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status))
    return fail(path.string() + ": not a regular file");
  std::unique_ptr<std::FILE, CloseFile> file(std::fopen(path.c_str(), "rb"));
  if (!file) return fail(path.string() + ": cannot be opened: " + std::strerror(errno));
  return std::make_unique<RawSource>(path, std::move(file), options);
}

}  // namespace armature
