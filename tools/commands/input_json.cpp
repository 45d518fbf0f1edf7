#include "tools/commands/input_json.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <optional>
#include <set>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace armature::tools {
namespace {

constexpr std::size_t kLargestFile = std::size_t{1} << 26U;

bool is_finite(const InputJson::Json& json) {
  return json.is_number() && std::isfinite(json.get<double>());
}

}  // namespace

std::string shown(std::string_view text) {
  std::string result;
  for (const char c : text.substr(0, 40)) result += c >= ' ' && c <= '~' ? c : '?';
  return '"' + result + (text.size() > 40 ? "...\"" : "\"");
}

std::string InputJson::shown_value(const Json& value) {
  if (value.is_string()) return shown(value.get_ref<const std::string&>());
  if (value.is_structured()) return value.is_array() ? "a list" : "an object";
  return value.dump(-1, ' ', true, Json::error_handler_t::replace);
}

Expected<std::string> InputJson::read_file(const std::string& file, std::string_view what) {
  std::ifstream in(file, std::ios::binary);
  std::string bytes;
  if (in) {
    bytes.resize(kLargestFile + 1);
    in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    bytes.resize(static_cast<std::size_t>(in.gcount()));
  }
  if (in.bad() || !in.is_open()) return fail(fmt::format("{}: cannot be read; expected {} as JSON", file, what));
  return bytes;
}

Expected<InputJson::Json> InputJson::parse(std::string_view bytes) const {
  if (bytes.size() > kLargestFile) return fail(fmt::format("{}: is larger than 64 MB; say less", name_));
  std::vector<std::set<std::string>> keys;  // by depth, of the objects that are open
  std::optional<std::string> twice;
  const auto look = [&](int, Json::parse_event_t event, Json& value) {
    if (event == Json::parse_event_t::object_start) keys.emplace_back();
    if (event == Json::parse_event_t::object_end) keys.pop_back();
    if (event == Json::parse_event_t::key && !keys.back().insert(value.get<std::string>()).second)
      twice = value.get<std::string>();
    return true;
  };
  try {
    Json json = Json::parse(bytes.begin(), bytes.end(), look);
    if (twice) return refuse(shown(*twice), "stands there twice; keep one");
    return json;
  } catch (const Json::parse_error& error) {
    const std::string_view before = bytes.substr(0, error.byte);
    const auto line = 1 + std::count(before.begin(), before.end(), '\n');
    const std::size_t column = before.size() - std::min(before.size(), before.rfind('\n') + 1);
    return fail(fmt::format("{}, line {}, column {}: is no JSON; expected {}", name_, line,
                            std::max<std::size_t>(1, column), example_));
  } catch (const Json::exception&) {
    return fail(fmt::format("{}: holds a number that is too large; expected finite numbers", name_));
  }
}

Expected<void> InputJson::only_keys(const Json& json, std::initializer_list<std::string_view> known,
                                    const std::string& place) const {
  for (const auto& [key, value] : json.items())
    if (std::ranges::find(known, key) == known.end())
      return refuse(place + shown(key), fmt::format("is no key here; expected {}", fmt::join(known, ", ")));
  return {};
}

Expected<Eigen::Vector3d> InputJson::vector(const Json& json, const std::string& place) const {
  if (!json.is_array() || json.size() != 3 || !std::ranges::all_of(json, is_finite))
    return refuse(place, "expected three finite numbers [x,y,z], found " + shown_value(json));
  return Eigen::Vector3d(json[0].get<double>(), json[1].get<double>(), json[2].get<double>());
}

Expected<double> InputJson::number(const Json& json, const std::string& place) const {
  if (!is_finite(json)) return refuse(place, "expected a finite number, found " + shown_value(json));
  return json.get<double>();
}

tl::unexpected<Error> InputJson::refuse(const std::string& place, const std::string& what) const {
  return fail(fmt::format("{}, {}: {}", name_, place, what));
}

}  // namespace armature::tools
