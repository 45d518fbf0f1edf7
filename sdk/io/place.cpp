#include "sdk/io/place.h"

namespace armature::sdk {

std::string quoted(std::string_view found) {
  constexpr std::size_t kShown = 24;
  std::string text = "'";
  for (const char c : found.substr(0, kShown)) text += c >= ' ' && c <= '~' ? c : '?';
  text += found.size() > kShown ? "...'" : "'";
  return text;
}

tl::unexpected<Error> fail_at_line(std::string_view name, std::size_t line, std::string_view message) {
  return fail(std::string(name) + ", line " + std::to_string(line) + ": " + std::string(message));
}

tl::unexpected<Error> fail_at_byte(std::string_view name, std::size_t byte, std::string_view message) {
  return fail(std::string(name) + ", byte " + std::to_string(byte) + ": " + std::string(message));
}

}  // namespace armature::sdk
