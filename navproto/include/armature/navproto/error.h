#pragma once

#include <string>
#include <utility>

#include <tl/expected.hpp>

namespace armature::navproto {

/// An expected failure at the wire. The message is one line that names the endpoint or message, the place in it and
/// what was expected instead.
struct Error {
  std::string message;  ///< without a newline
};

/// A value, or why there is none.
template <class T>
using Expected = tl::expected<T, Error>;

/// A failure, to be returned.
[[nodiscard]] inline tl::unexpected<Error> fail(std::string message) {
  return tl::unexpected(Error{std::move(message)});
}

}  // namespace armature::navproto
