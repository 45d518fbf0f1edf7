#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <string_view>

#include "firmware_host/error.h"
#include "tracker/pipeline.h"

namespace armature {

/// Who stands in front of the sensor: sets the default pair, which turn and walk override.
enum class Profile : std::uint8_t { Standing, Seated };
inline constexpr std::array<std::string_view, 2> kProfileNames = {"standing", "seated"};

/// Everything that can be set, with its defaults. The TOML file names, documents and bounds each of them.
struct Config {
  std::string source;                                ///< URI; empty: named on the command line
  bool lossless = false;                             ///< a recording is read frame by frame, none dropped
  std::string endpoint = "ipc:///run/armature/nav";  ///< where navigation is published
  bool insecure = false;                             ///< a tcp endpoint without keys, for whoever asks
  std::string keys;                                  ///< CURVE: our own pair (`armature keys new`), for tcp
  std::string allow;                                 ///< CURVE: the list of keys that may connect, for tcp
  std::string control;                               ///< base of the control socket; empty: beside the endpoint
  std::string control_uids;                          ///< who may change something, besides root and our own user
  int metrics_port = 0;                              ///< on 127.0.0.1; 0 = none
  std::string background;                            ///< the empty site (`armature doctor --background`); empty: none
  std::string model;                                 ///< a forest; empty: the one that is installed
  Profile profile = Profile::Standing;
  TrackerOptions tracker;
  /// Where what is not its default was set: by key ("source.uri") "FILE:LINE", or the option of the command line.
  std::map<std::string, std::string, std::less<>> set_at;
};

/// An error about what a key is set to, in the form that load_config() has: PLACE: key = value: why. What `why` says of
/// the value first is not said twice.
[[nodiscard]] tl::unexpected<Error> refuse(const Config& config, std::string_view key, std::string_view value,
                                           std::string_view why);

/// Reads and validates a TOML file, and the background it names. An unknown key, a wrong type, a value out of range or
/// a pair that cannot be steered with is an error of one line: FILE:LINE: key = value: what was expected.
[[nodiscard]] Expected<Config> load_config(const std::filesystem::path& path);
/// The same for a text; `name` stands for the file in messages.
[[nodiscard]] Expected<Config> parse_config(std::string_view text, std::string_view name);

/// The configuration as a commented TOML file with every key, which parse_config() reads back to the same.
[[nodiscard]] std::string print_config(const Config& config);

}  // namespace armature
