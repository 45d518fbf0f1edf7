#pragma once

#include <string>

#include <tl/expected.hpp>

namespace armature {

/// An expected failure at a boundary (file, device, option). The message is one line that names the file, the place
/// in it and what was expected instead.
struct Error {
  std::string message;
};

template <class T>
using Expected = tl::expected<T, Error>;

[[nodiscard]] inline tl::unexpected<Error> fail(std::string message) {
  return tl::unexpected(Error{std::move(message)});
}

}  // namespace armature
