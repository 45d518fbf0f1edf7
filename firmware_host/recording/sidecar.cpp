#include "firmware_host/recording/sidecar.h"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <limits>
#include <sstream>

#include <toml++/toml.h>

#include "firmware_host/recording/file_reader.h"

namespace armature {
namespace {

constexpr std::uint64_t kMaxSidecarBytes = 1 << 20;
constexpr std::int64_t kVersion = 1;
constexpr double kMaxPixels = 1e6;  // of a focal length, or of a principal point's distance from the image
constexpr double kMaxFramesPerSecond = 1e4;

std::string place(std::string_view name, const toml::node& node) {
  return std::string(name) + ":" + std::to_string(node.source().begin.line) + ": ";
}

/// Takes keys out of the table one by one, so that what is left over is what nobody knows.
struct Keys {
  toml::table& table;
  std::string_view name;
  std::string error;

  const toml::node* find(const char* key) {
    const toml::node* node = table.get(key);
    if (node == nullptr && error.empty()) error = std::string(name) + ": expected the key '" + key + "'";
    return node;
  }
  double number(const char* key, double low, double high) {
    const toml::node* node = find(key);
    if (node == nullptr) return 0;
    const auto value = node->value<double>();
    if ((!value || !(*value >= low && *value <= high)) && error.empty()) {
      std::ostringstream range;
      range << low << " to " << high;
      error = place(name, *node) + key + ": expected a number from " + range.str();
    }
    table.erase(key);
    return value.value_or(0);
  }
  std::int64_t integer(const char* key, std::int64_t low, std::int64_t high) {
    const toml::node* node = find(key);
    if (node == nullptr) return 0;
    const auto value = node->value_exact<std::int64_t>();
    if ((!value || *value < low || *value > high) && error.empty())
      error = place(name, *node) + key + ": expected a whole number from " + std::to_string(low) + " to " +
              std::to_string(high);
    table.erase(key);
    return value.value_or(0);
  }
  std::string text(const char* key) {
    const toml::node* node = find(key);
    if (node == nullptr) return {};
    const auto value = node->value_exact<std::string>();
    if (!value && error.empty()) error = place(name, *node) + key + ": expected a string";
    table.erase(key);
    return value.value_or("");
  }
};

// The shortest text that reads back as the same double, and as a float rather than an integer.
std::string number_text(double value) {
  std::array<char, 32> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr;
  std::string text(buffer.data(), end);
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text;
}

// On one line, so that no prefix of it is a string of its own.
std::string string_text(std::string_view value) {
  std::string text = "\"";
  for (const char c : value) {
    if (c == '"' || c == '\\') {
      text += '\\';
      text += c;
    } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      std::array<char, 8> code{};
      std::snprintf(code.data(), code.size(), "\\u%04X", static_cast<unsigned>(c));
      text += code.data();
    } else {
      text += c;
    }
  }
  return text + '"';
}

std::string one_line(std::string_view text) {
  std::string line;
  for (const char c : text) line += c == '\n' ? ' ' : c;
  return line;
}

}  // namespace

std::filesystem::path sidecar_path(const std::filesystem::path& recording) {
  auto path = recording;
  path += ".toml";
  return path;
}

std::string format_sidecar(const RecordingFacts& facts) {
  const Intrinsics& k = facts.intrinsics;
  std::ostringstream text;
  text << "# What the recording beside this file has no place for. A pixel (u, v) has its centre at the integer (u, "
          "v);\n"
       << "# a point (x, y, z) projects to u = centre_x_px + focal_x_px x/z, v = centre_y_px + focal_y_px y/z.\n"
       << "version = " << kVersion << "\n"
       << "width = " << k.width << "\n"
       << "height = " << k.height << "\n"
       << "focal_x_px = " << number_text(k.focal_x_px) << "\n"
       << "focal_y_px = " << number_text(k.focal_y_px) << "\n"
       << "centre_x_px = " << number_text(k.centre_x_px) << "\n"
       << "centre_y_px = " << number_text(k.centre_y_px) << "\n"
       << "frames_per_second = " << number_text(facts.frames_per_second) << "\n"
       << "origin = " << string_text(facts.origin) << "\n";
  return text.str();
}

Expected<RecordingFacts> parse_sidecar(std::string_view text, std::string_view name) {
  toml::table table;
  try {
    table = toml::parse(text);
  } catch (const toml::parse_error& error) {
    return fail(std::string(name) + ":" + std::to_string(error.source().begin.line) + ": " +
                one_line(error.description()));
  }
  Keys keys{table, name, {}};
  RecordingFacts facts;
  Intrinsics& k = facts.intrinsics;
  keys.integer("version", kVersion, kVersion);
  k.width = static_cast<int>(keys.integer("width", 1, kMaxImageSide));
  k.height = static_cast<int>(keys.integer("height", 1, kMaxImageSide));
  constexpr double kTiny = std::numeric_limits<double>::min();
  k.focal_x_px = keys.number("focal_x_px", kTiny, kMaxPixels);
  k.focal_y_px = keys.number("focal_y_px", kTiny, kMaxPixels);
  k.centre_x_px = keys.number("centre_x_px", -kMaxPixels, kMaxPixels);
  k.centre_y_px = keys.number("centre_y_px", -kMaxPixels, kMaxPixels);
  facts.frames_per_second = keys.number("frames_per_second", kTiny, kMaxFramesPerSecond);
  facts.origin = keys.text("origin");
  if (keys.error.empty() && !table.empty())
    keys.error =
        place(name, table.begin()->second) + "unknown key '" + one_line(std::string(table.begin()->first)) + "'";
  if (!keys.error.empty()) return fail(std::move(keys.error));
  return facts;
}

Expected<RecordingFacts> read_sidecar(const std::filesystem::path& path) {
  const auto bytes = read_file(path, kMaxSidecarBytes);
  if (!bytes) return tl::unexpected(bytes.error());
  return parse_sidecar({reinterpret_cast<const char*>(bytes->data()), bytes->size()}, path.string());
}

}  // namespace armature
