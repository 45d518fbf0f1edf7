#pragma once

#include <cmath>
#include <cstdio>

#include <nlohmann/json.hpp>

#include "firmware_host/error.h"

namespace armature::tools {

/// Keeps keys in the order they were set, so that two equal results are equal bytes.
using Json = nlohmann::ordered_json;

/// A number as results print it: six decimals (micrometres, microradians), no negative zero, and 0 for what is not
/// finite, since JSON has no word for it.
[[nodiscard]] inline double number(double value) noexcept {
  if (!std::isfinite(value)) return 0;
  const double rounded = std::round(value * 1e6) / 1e6;
  return std::isfinite(rounded) ? rounded + 0.0 : value;
}

/// One JSON object on a line of its own, flushed, so that a reader at the other end of a pipe sees it at once.
[[nodiscard]] inline Expected<void> write_json_line(std::FILE* out, const Json& object) {
  // What is no UTF-8 (a file's name) is replaced rather than thrown about.
  const std::string line = object.dump(-1, ' ', false, Json::error_handler_t::replace) + '\n';
  if (std::fwrite(line.data(), 1, line.size(), out) != line.size() || std::fflush(out) != 0) {
    return fail("standard output: cannot be written (disk full or reader gone)");
  }
  return {};
}

}  // namespace armature::tools
