#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include <armature/sdk/error.h>

namespace armature::sdk {

/// A piece of a hostile file as messages show it: in quotes, short, printable.
[[nodiscard]] std::string quoted(std::string_view found);

/// "NAME, line 12: MESSAGE", to be returned.
[[nodiscard]] tl::unexpected<Error> fail_at_line(std::string_view name, std::size_t line, std::string_view message);
/// "NAME, byte 12: MESSAGE", to be returned.
[[nodiscard]] tl::unexpected<Error> fail_at_byte(std::string_view name, std::size_t byte, std::string_view message);

}  // namespace armature::sdk
