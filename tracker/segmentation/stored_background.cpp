#include "tracker/segmentation/stored_background.h"

#include <algorithm>
#include <charconv>

#include "firmware_host/recording/file_reader.h"

namespace armature {
namespace {

constexpr std::size_t kMaxBytes = std::size_t{2} * kMaxImageSide * kMaxImageSide + 64;
constexpr std::string_view kBlank = " \t\r\n";

/// Cuts the next word of the header off, and the one blank that ends it.
std::string_view take_word(std::string_view& text) {
  text.remove_prefix(std::min(text.find_first_not_of(kBlank), text.size()));
  const auto word = text.substr(0, text.find_first_of(kBlank));
  text.remove_prefix(std::min(word.size() + 1, text.size()));
  return word;
}

int number_in(std::string_view word) {
  int value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc() && end == word.data() + word.size() ? value : -1;
}

}  // namespace

StoredBackground median_of(std::span<const DepthFrame> frames) {
  const Intrinsics& k = frames.front().intrinsics;
  StoredBackground background{k.width, k.height, std::vector<std::uint16_t>(frames.front().depth_mm.size())};
  std::vector<std::uint16_t> returns;
  for (std::size_t i = 0; i < background.depth_mm.size(); ++i) {
    returns.clear();
    for (const DepthFrame& frame : frames) {
      if (frame.depth_mm[i] != 0) returns.push_back(frame.depth_mm[i]);
    }
    if (2 * returns.size() < frames.size()) continue;
    const auto middle = returns.begin() + static_cast<std::ptrdiff_t>(returns.size() / 2);
    std::nth_element(returns.begin(), middle, returns.end());
    background.depth_mm[i] = *middle;
  }
  return background;
}

Expected<StoredBackground> parse_background(std::span<const std::byte> bytes, std::string_view name) {
  std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const bool magic = take_word(text) == "P5";
  StoredBackground background;
  background.width = number_in(take_word(text));
  background.height = number_in(take_word(text));
  if (!magic || background.width < 1 || background.height < 1 || background.width > kMaxImageSide ||
      background.height > kMaxImageSide || number_in(take_word(text)) != 65535)
    return fail(std::string(name) + ": expected a background made by `armature doctor`: 'P5 WIDTH HEIGHT 65535'");
  const auto pixels = static_cast<std::size_t>(background.width) * static_cast<std::size_t>(background.height);
  if (text.size() != 2 * pixels)
    return fail(std::string(name) + ": " + std::to_string(text.size()) + " bytes of pixels: expected " +
                std::to_string(2 * pixels));
  background.depth_mm.resize(pixels);
  const auto* byte = reinterpret_cast<const std::uint8_t*>(text.data());
  for (std::uint16_t& depth : background.depth_mm) {
    depth = static_cast<std::uint16_t>(byte[0] << 8U | byte[1]);
    byte += 2;
  }
  return background;
}

Expected<StoredBackground> read_background(const std::filesystem::path& file) {
  const auto bytes = read_file(file, kMaxBytes);
  if (!bytes) return tl::unexpected(bytes.error());
  return parse_background(*bytes, file.string());
}

std::string print_background(const StoredBackground& background) {
  std::string bytes = "P5\n" + std::to_string(background.width) + " " + std::to_string(background.height) + "\n65535\n";
  bytes.reserve(bytes.size() + 2 * background.depth_mm.size());
  for (const std::uint16_t depth : background.depth_mm) {
    bytes += static_cast<char>(depth >> 8U);
    bytes += static_cast<char>(depth);
  }
  return bytes;
}

}  // namespace armature
