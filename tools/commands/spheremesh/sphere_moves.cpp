#include "tools/commands/spheremesh/sphere_moves.h"

#include <cstdint>

#include <fmt/format.h>

#include "tools/commands/input_json.h"

namespace armature::tools {
namespace {

using Json = InputJson::Json;

class Reader : public InputJson {
 public:
  Reader(std::string_view name, std::size_t spheres)
      : InputJson(name, "a list of moves as in [{\"spheres\":[0],\"translate\":[0,0,1]}]"), spheres_(spheres) {}

  Expected<std::vector<sdk::SphereMove>> moves(const Json& json) const {
    if (!json.is_array())
      return refuse("the whole", "expected a list of moves, found " + shown_value(json) + "; put it into [ ]");
    std::vector<sdk::SphereMove> moves;
    for (std::size_t i = 0; i < json.size(); ++i) {
      auto read = move(json[i], fmt::format("[{}]", i));
      if (!read) return tl::unexpected(read.error());
      moves.push_back(std::move(*read));
    }
    return moves;
  }

 private:
  Expected<sdk::SphereMove> move(const Json& json, const std::string& place) const {
    if (!json.is_object()) return refuse(place, "expected an object, found " + shown_value(json));
    if (auto known = only_keys(json, {"spheres", "translate", "rotate", "about", "scale", "radius"}, place + ", ");
        !known)
      return tl::unexpected(known.error());
    sdk::SphereMove move;
    const auto spheres = json.find("spheres");
    if (spheres == json.end() || !spheres->is_array())
      return refuse(place + ", \"spheres\"",
                    fmt::format("expected a list of spheres [i,...], {}",
                                spheres == json.end() ? "found nothing" : "found " + shown_value(*spheres)));
    for (std::size_t k = 0; k < spheres->size(); ++k) {
      const Json& sphere = (*spheres)[k];
      if (!sphere.is_number_unsigned() || sphere.get<std::uint64_t>() >= spheres_)
        return refuse(fmt::format("{}, \"spheres\"[{}]", place, k),
                      fmt::format("expected a whole number from 0 to {}, the level's last sphere, found {}",
                                  spheres_ - 1, shown_value(sphere)));
      move.spheres.emplace_back(sphere.get<std::uint64_t>());
    }
    const auto take = [&](const char* key, auto&& reads, auto&& into) -> Expected<void> {
      const auto value = json.find(key);
      if (value == json.end()) return {};
      auto read = reads(*value, fmt::format("{}, \"{}\"", place, key));
      if (!read) return tl::unexpected(read.error());
      into = *read;
      return {};
    };
    const auto a_vector = [&](const Json& value, const std::string& at) { return vector(value, at); };
    const auto a_size = [&](bool or_zero) {
      return [this, or_zero](const Json& value, const std::string& at) -> Expected<double> {
        auto read = number(value, at);
        if (read && (*read < 0 || (*read == 0 && !or_zero)))
          return refuse(at, fmt::format("expected a number {}, found {}", or_zero ? "that is not negative" : "above 0",
                                        shown_value(value)));
        return read;
      };
    };
    return take("translate", a_vector, move.translate)
        .and_then([&] { return take("rotate", a_vector, move.rotate); })
        .and_then([&] { return take("about", a_vector, move.about); })
        .and_then([&] { return take("scale", a_size(false), move.scale); })
        .and_then([&] { return take("radius", a_size(true), move.radius); })
        .map([&] { return move; });
  }

  std::size_t spheres_;
};

}  // namespace

Expected<std::vector<sdk::SphereMove>> parse_sphere_moves(std::string_view bytes, std::string_view name,
                                                          std::size_t spheres) {
  const Reader reader(name, spheres);
  return reader.parse(bytes).and_then([&](const Json& json) { return reader.moves(json); });
}

Expected<std::vector<sdk::SphereMove>> read_sphere_moves(const std::string& file, std::size_t spheres) {
  return InputJson::read_file(file, "moves").and_then([&](const std::string& bytes) {
    return parse_sphere_moves(bytes, file, spheres);
  });
}

}  // namespace armature::tools
