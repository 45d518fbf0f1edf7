#include "viewer/app/png.h"

#include <string>
#include <system_error>

#include <png.h>
#include <unistd.h>

namespace armature::viewer {

sdk::Expected<void> write_png(const Image& image, const std::filesystem::path& path) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(image.width);
  png.height = static_cast<png_uint_32>(image.height);
  png.format = PNG_FORMAT_RGB;
  const std::filesystem::path unfinished = path.string() + ".part." + std::to_string(getpid());
  std::error_code error;
  if (png_image_write_to_file(&png, unfinished.c_str(), 0, image.rgb.data(), 0, nullptr) == 0) {
    std::filesystem::remove(unfinished, error);
    return sdk::fail(path.string() + ": cannot be written: " + png.message);
  }
  std::filesystem::rename(unfinished, path, error);
  if (error) {
    std::error_code ignored;
    std::filesystem::remove(unfinished, ignored);
    return sdk::fail(path.string() + ": cannot be written: " + error.message());
  }
  return {};
}

}  // namespace armature::viewer
