// Sessions as text: what is accepted is written and replayed to the same bits; what is not is refused in one line.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

#include <armature/sdk/deformation/session.h>
#include <armature/sdk/hierarchy/build.h>

#include "tests/sdk/mesh/surfaces.h"

namespace {

using namespace armature::sdk;

/// A session of a small ball, as new whenever it is asked for.
class Sessions {
 public:
  Sessions() : sessions_{start(), start()} {}
  [[nodiscard]] DeformationSession& fresh(int which) {
    DeformationSession& session = which == 0 ? sessions_.first : sessions_.second;
    while (session.undo()) {
    }
    (void)session.go_to(kLevel);
    return session;
  }

 private:
  static constexpr std::size_t kLevel = 4;
  [[nodiscard]] DeformationSession start() const {
    return DeformationSession::start(mesh_, hierarchy_, kLevel).value();
  }

  Mesh mesh_ = surfaces::icosphere(1);
  Hierarchy hierarchy_ = build_hierarchy(mesh_).value().hierarchy;
  std::pair<DeformationSession, DeformationSession> sessions_;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static Sessions sessions;
  DeformationSession& session = sessions.fresh(0);
  const auto replayed = session.replay({reinterpret_cast<const char*>(data), size}, "fuzzed");
  for (const auto& position : session.positions())
    if (!position.allFinite()) __builtin_trap();
  for (const auto& sphere : session.shape().spheres)
    if (!sphere.centre.allFinite() || !std::isfinite(sphere.radius)) __builtin_trap();
  if (!replayed && replayed.error().message.find('\n') != std::string::npos) __builtin_trap();
  // What was carried out is a session as well.
  if (!replayed && session.steps() > 0) __builtin_trap();
  DeformationSession& again = sessions.fresh(1);
  const std::string text = session.text();
  if (!again.replay(text, "again") || again.text() != text) __builtin_trap();
  if (!std::ranges::equal(session.positions(), again.positions())) __builtin_trap();
  return 0;
}
