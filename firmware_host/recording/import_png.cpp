#include <algorithm>
#include <array>
#include <cerrno>
#include <csetjmp>
#include <cstdio>
#include <cstring>

#include <png.h>

#include "firmware_host/recording/import.h"

namespace armature {
namespace {

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

/// What libpng jumps out of. It lives outside the frame that libpng jumps over, so nothing is lost on the way.
struct Png {
  png_structp reader = nullptr;
  png_infop info = nullptr;
  std::array<char, 200> complaint{};
  std::vector<png_bytep> rows;

  Png() {
    reader = png_create_read_struct(PNG_LIBPNG_VER_STRING, this, &Png::on_error, [](png_structp, png_const_charp) {});
    if (reader != nullptr) info = png_create_info_struct(reader);
  }
  Png(const Png&) = delete;
  Png& operator=(const Png&) = delete;
  ~Png() { png_destroy_read_struct(&reader, &info, nullptr); }

  [[noreturn]] static void on_error(png_structp reader, png_const_charp message) {
    auto* self = static_cast<Png*>(png_get_error_ptr(reader));
    std::snprintf(self->complaint.data(), self->complaint.size(), "%s", message);
    png_longjmp(reader, 1);
  }
};

enum class Step : std::uint8_t { Header, Pixels };

// The only function that libpng may leave by a jump: nothing in it has a destructor.
bool run(Png& png, Step step, std::FILE* file) {
  if (setjmp(png_jmpbuf(png.reader)) != 0) return false;
  if (step == Step::Header) {
    png_init_io(png.reader, file);
    png_set_user_limits(png.reader, kMaxImageSide, kMaxImageSide);
    png_read_info(png.reader, png.info);
  } else {
    png_set_swap(png.reader);  // PNG is big-endian
    png_read_update_info(png.reader, png.info);
    png_read_image(png.reader, png.rows.data());
    png_read_end(png.reader, nullptr);
  }
  return true;
}

Expected<void> read_png(const std::filesystem::path& path, Intrinsics& size, std::vector<std::uint16_t>& depth_mm) {
  const std::string name = path.string();
  const std::unique_ptr<std::FILE, CloseFile> file(std::fopen(path.c_str(), "rb"));
  if (!file) return fail(name + ": cannot be opened: " + std::strerror(errno));
  Png png;
  if (png.info == nullptr) return fail(name + ": cannot be read: out of memory");
  if (!run(png, Step::Header, file.get())) return fail(name + ": not a PNG image: " + png.complaint.data());
  const auto width = static_cast<int>(png_get_image_width(png.reader, png.info));
  const auto height = static_cast<int>(png_get_image_height(png.reader, png.info));
  if (png_get_color_type(png.reader, png.info) != PNG_COLOR_TYPE_GRAY || png_get_bit_depth(png.reader, png.info) != 16)
    return fail(name + ": expected 16-bit grey pixels");
  if (size.width == 0) {
    size.width = width;
    size.height = height;
  }
  if (width != size.width || height != size.height)
    return fail(name + ": " + std::to_string(width) + " x " + std::to_string(height) + ": expected " +
                std::to_string(size.width) + " x " + std::to_string(size.height) + " as before");
  depth_mm.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  for (int v = 0; v < height; ++v)
    png.rows.push_back(reinterpret_cast<png_bytep>(depth_mm.data() + std::ptrdiff_t{v} * width));
  if (!run(png, Step::Pixels, file.get())) return fail(name + ": corrupt PNG image: " + png.complaint.data());
  return {};
}

class PngSource final : public DepthSource {
 public:
  PngSource(std::vector<std::filesystem::path> images, const ImportOptions& options) : images_(std::move(images)) {
    info_.uri = "png:" + images_.front().filename().string();
    info_.intrinsics = options.intrinsics;
    info_.frames_per_second = options.frames_per_second;
    info_.frame_count = static_cast<long>(images_.size());
  }

  [[nodiscard]] const SourceInfo& info() const noexcept override { return info_; }

  // The first image says how large all are.
  Expected<void> start() {
    std::vector<std::uint16_t> pixels;
    Intrinsics& k = info_.intrinsics;
    if (auto first = read_png(images_.front(), k, pixels); !first) return first;
    const Intrinsics nominal = nominal_intrinsics(k.width, k.height);
    if (k.focal_x_px == 0) k.focal_x_px = nominal.focal_x_px;
    if (k.focal_y_px == 0) k.focal_y_px = nominal.focal_y_px;
    if (k.centre_x_px == 0 && k.centre_y_px == 0) {
      k.centre_x_px = nominal.centre_x_px;
      k.centre_y_px = nominal.centre_y_px;
    }
    return {};
  }

  Expected<ReadStatus> read(DepthFrame& frame, std::chrono::milliseconds) override {
    if (next_ == images_.size()) return ReadStatus::EndOfStream;
    if (auto read = read_png(images_[next_], info_.intrinsics, frame.depth_mm); !read)
      return tl::unexpected(read.error());
    frame.intrinsics = info_.intrinsics;
    frame.sequence = next_;
    const auto time = std::chrono::duration<double>(static_cast<double>(next_) / info_.frames_per_second);
    frame.sensor = {std::chrono::round<std::chrono::nanoseconds>(time), ClockId::Recording};
    ++next_;
    return ReadStatus::Frame;
  }

 private:
  std::vector<std::filesystem::path> images_;
  SourceInfo info_;
  std::size_t next_ = 0;
};

}  // namespace

Expected<std::unique_ptr<DepthSource>> open_png_depth(std::vector<std::filesystem::path> images,
                                                      const ImportOptions& options) {
  if (images.empty()) return fail("no PNG images: expected at least one");
  auto source = std::make_unique<PngSource>(std::move(images), options);
  if (auto started = source->start(); !started) return tl::unexpected(started.error());
  return source;
}

Expected<std::vector<std::filesystem::path>> list_png_images(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> images;
  std::error_code error;
  for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    if (entry->path().extension() == ".png") images.push_back(entry->path());
  if (error) return fail(folder.string() + ": cannot be listed: " + error.message());
  if (images.empty()) return fail(folder.string() + ": holds no .png files");
  std::sort(images.begin(), images.end());
  return images;
}

}  // namespace armature
