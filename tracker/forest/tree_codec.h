#pragma once

#include <optional>

#include "tracker/forest/bytes.h"
#include "tracker/forest/forest.h"

namespace armature {

/// u32 node_count; u32 leaf_count; nodes; leaves, little-endian.
///   node: i16 u[2]; i16 v[2]; i16 threshold; i32 child[2]                     (18 bytes)
///   leaf: u8 probability[31]; 8 times: i8 offset[3]; u8 joint; u8 weight_code (71 bytes)
void put_tree(ByteWriter& out, const Tree& tree);

/// Nothing if the bytes end too early. The tree's indices are unchecked: Forest::create() does that.
[[nodiscard]] std::optional<Tree> get_tree(ByteReader& in);

}  // namespace armature
