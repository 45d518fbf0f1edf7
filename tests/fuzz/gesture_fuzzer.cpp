// Gestures: what is accepted names faces that are there; what is not is refused in one line.
#include <cstdint>
#include <string_view>

#include "tools/commands/select/gesture.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace armature::tools;
  constexpr std::size_t kFaces = 12;
  const auto gesture = parse_gesture({reinterpret_cast<const char*>(data), size}, "fuzzed.json", kFaces);
  if (!gesture) {
    if (gesture.error().message.find('\n') != std::string::npos) __builtin_trap();
    return 0;
  }
  if (const auto* click = std::get_if<ComponentGesture>(&*gesture))
    if (click->face.index() >= kFaces) __builtin_trap();
  if (const auto* brushed = std::get_if<PatchGesture>(&*gesture)) {
    if (!(brushed->drawn.radius > 0) || brushed->drawn.strokes.empty()) __builtin_trap();
    for (const auto& stroke : brushed->drawn.strokes)
      for (const auto& point : stroke)
        if (!point.allFinite()) __builtin_trap();
  }
  return 0;
}
