#include <charconv>
#include <cmath>
#include <string>

#include "tracker/synth/synth_source.h"

namespace armature {
namespace {

constexpr std::array<std::pair<std::string_view, Outfit::Bag>, 6> kCarried = {{{"nothing", Outfit::Bag::None},
                                                                               {"bag", Outfit::Bag::Hand},
                                                                               {"shoulder_bag", Outfit::Bag::Shoulder},
                                                                               {"backpack", Outfit::Bag::Backpack},
                                                                               {"mug", Outfit::Bag::Mug},
                                                                               {"phone", Outfit::Bag::Phone}}};

/// The whole text as a number within bounds.
template <class T>
bool parse(std::string_view text, T least, T most, T& out) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !(value >= least && value <= most)) return false;
  out = value;
  return true;
}

bool parse_size(std::string_view text, SynthOptions& options) {
  const auto cross = text.find('x');
  return cross != std::string_view::npos && parse(text.substr(0, cross), 16, kMaxImageSide, options.width) &&
         parse(text.substr(cross + 1), 16, kMaxImageSide, options.height);
}

bool parse_carried(std::string_view text, SynthOptions& options) {
  for (const auto& [name, bag] : kCarried) {
    if (text == name) {
      options.carry = bag;
      return true;
    }
  }
  return false;
}

/// What an option takes, in words, or empty where it is unknown; `good` tells whether it was taken.
std::string_view take_option(std::string_view key, std::string_view value, SynthOptions& options, bool& good) {
  const auto taken = [&](bool ok, std::string_view expected) {
    good = ok;
    return expected;
  };
  if (key == "seed") return taken(parse(value, std::uint64_t{0}, ~std::uint64_t{0}, options.seed), "a whole number");
  if (key == "size") return taken(parse_size(value, options), "WIDTHxHEIGHT, each 16 to 4096");
  if (key == "fps") return taken(parse(value, 1.0, 240.0, options.fps), "1 to 240");
  if (key == "turned_deg") return taken(parse(value, -90.0, 90.0, options.turned_deg), "-90 to 90");
  if (key == "distance") return taken(parse(value, 0.8, 6.0, options.distance_m), "0.8 to 6 (metres)");
  if (key == "noise") return taken(parse(value, 0.0, 3.0, options.noise), "0 to 3");
  if (key == "carry") return taken(parse_carried(value, options), "nothing, bag, shoulder_bag, backpack, mug or phone");
  return {};
}

}  // namespace

Expected<std::unique_ptr<SynthSource>> SynthSource::open(std::string_view name_and_options,
                                                         const OpenOptions& options) {
  const auto question = name_and_options.find('?');
  const auto name = name_and_options.substr(0, question);
  const std::string uri = "source 'synth:" + std::string(name_and_options) + "': ";
  const Script* script = find_script(name);
  if (script == nullptr) {
    std::string names;
    for (const Script& known : scripts()) names += (names.empty() ? "" : ", ") + known.name;
    return fail(uri + "no script '" + std::string(name) + "'; there are " + names);
  }
  SynthOptions synth;
  auto rest = question == std::string_view::npos ? std::string_view{} : name_and_options.substr(question + 1);
  while (!rest.empty()) {
    const auto ampersand = rest.find('&');
    const auto option = rest.substr(0, ampersand);
    rest = ampersand == std::string_view::npos ? std::string_view{} : rest.substr(ampersand + 1);
    const auto equals = option.find('=');
    const auto key = option.substr(0, equals);
    const auto value = equals == std::string_view::npos ? std::string_view{} : option.substr(equals + 1);
    bool good = false;
    const auto expected = take_option(key, value, synth, good);
    if (expected.empty()) {
      return fail(uri + "unknown option '" + std::string(key) +
                  "'; there are seed, size, fps, turned_deg, distance, noise and carry");
    }
    if (!good) return fail(uri + std::string(key) + " '" + std::string(value) + "': expected " + std::string(expected));
  }
  return open(*script, synth, options);
}

Expected<std::unique_ptr<SynthSource>> SynthSource::open(const Script& script, const SynthOptions& synth,
                                                         const OpenOptions& options) {
  if (synth.width < 16 || synth.height < 16 || synth.width > kMaxImageSide || synth.height > kMaxImageSide) {
    return fail("synth:" + script.name + ": " + std::to_string(synth.width) + "x" + std::to_string(synth.height) +
                " pixels: expected sides of 16 to " + std::to_string(kMaxImageSide));
  }
  auto source = std::unique_ptr<SynthSource>(new SynthSource(script, synth, options));
  source->info_.uri = "synth:" + script.name + "?seed=" + std::to_string(synth.seed) +
                      "&size=" + std::to_string(synth.width) + "x" + std::to_string(synth.height);
  return source;
}

std::string describe_scripts() {
  std::string text;
  for (const Script& script : scripts()) {
    text += "  " + script.name + std::string(script.name.size() < 17 ? 17 - script.name.size() : 1, ' ') +
            script.description + "\n";
  }
  return text;
}

}  // namespace armature
