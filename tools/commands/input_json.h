#pragma once

#include <initializer_list>
#include <string>
#include <string_view>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "firmware_host/error.h"

namespace armature::tools {

/// A text from a hostile file as messages show it: short, printable and in quotes.
[[nodiscard]] std::string shown(std::string_view text);

/// JSON from a user, walked so that every failure is one line with the file and the place in it.
class InputJson {
 public:
  using Json = nlohmann::json;

  /// `name` stands for the file in messages, and must outlive this; `example` shows what is expected.
  InputJson(std::string_view name, std::string_view example) : name_(name), example_(example) {}

  /// The contents of a file, at most 64 MB.
  [[nodiscard]] static Expected<std::string> read_file(const std::string& file, std::string_view what);

  /// Refused: what is larger than 64 MB, no JSON, or says something twice.
  [[nodiscard]] Expected<Json> parse(std::string_view bytes) const;

  /// Refused: an object with other keys than these. `place` ends in ", " or is empty.
  [[nodiscard]] Expected<void> only_keys(const Json& json, std::initializer_list<std::string_view> known,
                                         const std::string& place = {}) const;
  /// Refused: what is not three finite numbers.
  [[nodiscard]] Expected<Eigen::Vector3d> vector(const Json& json, const std::string& place) const;
  /// Refused: what is not a finite number.
  [[nodiscard]] Expected<double> number(const Json& json, const std::string& place) const;

  /// A value as messages show it.
  [[nodiscard]] static std::string shown_value(const Json& value);
  /// "NAME, place: what"
  [[nodiscard]] tl::unexpected<Error> refuse(const std::string& place, const std::string& what) const;

 private:
  std::string_view name_;
  std::string_view example_;
};

}  // namespace armature::tools
