#pragma once

#include <cstdint>

namespace armature::navproto {

/// A number that no other session has, and not zero.
[[nodiscard]] std::uint64_t random_session_id();

}  // namespace armature::navproto
