#include "viewer/app/sending.h"

#include <chrono>

namespace armature::viewer {

bool Sending::go_on() {
  constexpr auto kPatience = std::chrono::milliseconds(8);
  const auto start = std::chrono::steady_clock::now();
  while (!drawing_.send_some())
    if (std::chrono::steady_clock::now() - start > kPatience) return false;
  return true;
}

}  // namespace armature::viewer
