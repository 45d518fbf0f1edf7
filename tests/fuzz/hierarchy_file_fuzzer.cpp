#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include <armature/sdk/hierarchy/hierarchy_file.h>
#include <armature/sdk/hierarchy/level_cursor.h>

#include "sdk/hierarchy/checksum.h"

namespace {

using namespace armature::sdk;

/// A hierarchy that the reader accepts must also be safe to walk.
void walk(const Hierarchy& hierarchy) {
  if (hierarchy.leaf_count() > 2000) return;
  LevelCursor cursor(hierarchy, hierarchy.leaf_count());
  while (cursor.coarsen()) (void)hierarchy.level(cursor.size());
  while (cursor.refine()) (void)cursor.sphere_mesh();
  (void)hierarchy.cut(hierarchy.nodes_of_level(hierarchy.min_spheres()));
}

}  // namespace

/// The first byte chooses: the rest as a whole file, or as what lies behind a header that fits it.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view input(reinterpret_cast<const char*>(data) + 1, size - 1);
  std::string file;
  if (data[0] % 2 == 1) {
    file = "\x89SMH\r\n\x1a\n";
    const auto put = [&](std::uint64_t value, int bytes) {
      for (int k = 0; k < bytes; ++k) file += static_cast<char>(value >> (8 * k));
    };
    put(kHierarchyFileVersion, 4);
    put(crc32(input), 4);
    put(input.size(), 8);
  }
  file += input;
  const auto hierarchy = parse_hierarchy(file, "fuzz");
  if (hierarchy) walk(*hierarchy);
  return 0;
}
