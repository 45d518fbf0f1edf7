#include "tools/commands/select/gesture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tools/commands/choices.h"
#include "tools/commands/input_json.h"

namespace armature::tools {
namespace {

using Json = InputJson::Json;

/// The gesture's JSON as the reader walks it: every failure names the file and the place.
class Reader : public InputJson {
 public:
  Reader(std::string_view name, std::size_t faces)
      : InputJson(name, "a gesture as in {\"tool\":\"component\",\"face\":0}"), name_(name), faces_(faces) {}

  Expected<Gesture> gesture(const Json& json) const {
    if (!json.is_object()) return fail(fmt::format("{}: expected an object, found {}", name_, shown_value(json)));
    const auto tool = json.find("tool");
    if (tool == json.end()) return refuse("\"tool\"", fmt::format("is missing; expected one of {}", tools()));
    const auto known = std::ranges::find(kTools, tool->is_string() ? tool->get<std::string>() : "",
                                         [](const auto& entry) { return std::string(entry.first); });
    if (known == kTools.end())
      return refuse("\"tool\"", fmt::format("expected one of {}, found {}", tools(), shown_value(*tool)));
    return (this->*known->second)(json);
  }

 private:
  using Tool = Expected<Gesture> (Reader::*)(const Json&) const;
  static const std::array<std::pair<const char*, Tool>, 4> kTools;

  static std::string tools() {
    std::vector<std::string> names;
    for (const std::string& name : names_of(kTools)) names.push_back('"' + name + '"');
    return fmt::format("{}", fmt::join(names, ", "));
  }

  Expected<Gesture> component(const Json& json) const {
    if (auto checked = only_keys(json, {"tool", "face"}); !checked) return tl::unexpected(checked.error());
    const auto face = json.find("face");
    if (faces_ == 0) return refuse("\"tool\"", "there is no face to click on; expected \"patch\"");
    if (face == json.end()) return refuse("\"face\"", "is missing; expected the number of a face, from 0");
    if (!face->is_number_unsigned() || face->get<std::uint64_t>() >= faces_)
      return refuse("\"face\"", fmt::format("expected a whole number from 0 to {}, the mesh's last face, found {}",
                                            faces_ - 1, shown_value(*face)));
    return ComponentGesture{sdk::FaceId(face->get<std::uint64_t>())};
  }

  Expected<Gesture> patch(const Json& json) const {
    if (auto checked = only_keys(json, {"tool", "strokes", "radius", "background"}); !checked)
      return tl::unexpected(checked.error());
    PatchGesture gesture;
    const auto radius = length(json, "radius");
    if (!radius) return tl::unexpected(radius.error());
    gesture.drawn.radius = *radius;
    auto drawn = strokes(json, "strokes");
    if (!drawn) return tl::unexpected(drawn.error());
    if (drawn->empty()) return refuse("\"strokes\"", "expected at least one stroke over the patch");
    gesture.drawn.strokes = std::move(*drawn);
    if (json.contains("background")) {
      auto background = strokes(json, "background");
      if (!background) return tl::unexpected(background.error());
      gesture.drawn.background = std::move(*background);
    }
    return gesture;
  }

  Expected<Gesture> part(const Json& json) const {
    if (auto checked = only_keys(json, {"tool", "stroke"}); !checked) return tl::unexpected(checked.error());
    auto drawn = strokes(json, "stroke");
    if (!drawn) return tl::unexpected(drawn.error());
    if (drawn->empty()) return refuse("\"stroke\"", "expected points [[x,y,z],...] along the cut, found none");
    return PartGesture{std::move(*drawn)};
  }

  Expected<Gesture> lasso(const Json& json) const {
    if (auto checked = only_keys(json, {"tool", "loop", "eye", "direction", "through", "snap"}); !checked)
      return tl::unexpected(checked.error());
    LassoGesture gesture;
    auto loop = stroke(json.value("loop", Json()), "\"loop\"");
    if (!loop) return tl::unexpected(loop.error());
    gesture.drawn.loop = std::move(*loop);
    const bool has_eye = json.contains("eye");
    if (has_eye == json.contains("direction"))
      return refuse("\"eye\"", "expected either \"eye\", where the picture is seen from, or its \"direction\"");
    const auto view = vector(json[has_eye ? "eye" : "direction"], has_eye ? "\"eye\"" : "\"direction\"");
    if (!view) return tl::unexpected(view.error());
    if (has_eye)
      gesture.drawn.seen_from = sdk::Eye{*view};
    else
      gesture.drawn.seen_from = sdk::Gaze{*view};
    if (const auto through = json.find("through"); through != json.end()) {
      if (!through->is_boolean())
        return refuse("\"through\"", "expected true or false, found " + shown_value(*through));
      gesture.drawn.through = through->get<bool>();
    }
    if (json.contains("snap")) {
      const auto snap = length(json, "snap");
      if (!snap) return tl::unexpected(snap.error());
      gesture.snap = *snap;
    }
    return gesture;
  }

  using Stroke = std::vector<Eigen::Vector3d>;

  Expected<double> length(const Json& json, const std::string& key) const {
    const auto value = json.find(key);
    if (value == json.end() || !value->is_number() || !(value->get<double>() > 0) ||
        !std::isfinite(value->get<double>()))
      return refuse('"' + key + '"',
                    fmt::format("expected a positive number in the model's unit, {}",
                                value == json.end() ? "found nothing" : "found " + shown_value(*value)));
    return value->get<double>();
  }

  /// The strokes of a key: a list of them, or one alone.
  Expected<std::vector<Stroke>> strokes(const Json& json, const std::string& key) const {
    const auto value = json.find(key);
    if (value == json.end()) return refuse('"' + key + '"', "is missing; expected a list of strokes [[x,y,z],...]");
    if (!value->is_array()) return refuse('"' + key + '"', "expected a list of strokes, found " + shown_value(*value));
    const bool is_one = !value->empty() && (*value)[0].is_array() && !(*value)[0].empty() && (*value)[0][0].is_number();
    std::vector<Stroke> result;
    if (is_one) {
      auto one = stroke(*value, '"' + key + '"');
      if (!one) return tl::unexpected(one.error());
      result.push_back(std::move(*one));
      return result;
    }
    for (std::size_t i = 0; i < value->size(); ++i) {
      auto one = stroke((*value)[i], fmt::format("\"{}\"[{}]", key, i));
      if (!one) return tl::unexpected(one.error());
      result.push_back(std::move(*one));
    }
    return result;
  }

  Expected<Stroke> stroke(const Json& json, const std::string& place) const {
    if (!json.is_array() || json.empty())
      return refuse(place, "expected points [[x,y,z],...], found " + (json.is_array() ? "none" : shown_value(json)));
    Stroke points;
    points.reserve(json.size());
    for (std::size_t i = 0; i < json.size(); ++i) {
      const auto one = vector(json[i], fmt::format("{}[{}]", place, i));
      if (!one) return tl::unexpected(one.error());
      points.push_back(*one);
    }
    return points;
  }

  std::string_view name_;
  std::size_t faces_;
};

const std::array<std::pair<const char*, Reader::Tool>, 4> Reader::kTools = {
    {{"component", &Reader::component}, {"part", &Reader::part}, {"patch", &Reader::patch}, {"lasso", &Reader::lasso}}};

}  // namespace

Expected<Gesture> parse_gesture(std::string_view bytes, std::string_view name, std::size_t faces) {
  const Reader reader(name, faces);
  return reader.parse(bytes).and_then([&](const Json& json) { return reader.gesture(json); });
}

Expected<Gesture> read_gesture(const std::string& file, std::size_t faces) {
  return InputJson::read_file(file, "a gesture").and_then([&](const std::string& bytes) {
    return parse_gesture(bytes, file, faces);
  });
}

}  // namespace armature::tools
