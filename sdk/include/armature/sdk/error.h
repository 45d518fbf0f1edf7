#pragma once

#include <cstdint>
#include <string>
#include <utility>

#include <tl/expected.hpp>

namespace armature::sdk {

/// Why a call did not come to its end.
enum class ErrorKind : std::uint8_t {
  Input,      ///< a file, a shape or an option is not what was expected
  Cancelled,  ///< the caller's stop token asked for it
};

/// An expected failure. The message is one line that names the file or shape, the place in it and what was expected.
struct Error {
  std::string message;                ///< one line, without a newline
  ErrorKind kind = ErrorKind::Input;  ///< whose doing it is
};

/// A value, or why there is none. The library throws nothing but std::bad_alloc.
template <class T>
using Expected = tl::expected<T, Error>;

/// The failure of an input, to be returned: `return fail("cow.obj, line 12: ...")`.
[[nodiscard]] inline tl::unexpected<Error> fail(std::string message) {
  return tl::unexpected(Error{std::move(message), ErrorKind::Input});
}

/// What a long call returns once its caller asked it to stop.
[[nodiscard]] inline tl::unexpected<Error> cancelled() {
  return tl::unexpected(Error{"stopped on request", ErrorKind::Cancelled});
}

}  // namespace armature::sdk
