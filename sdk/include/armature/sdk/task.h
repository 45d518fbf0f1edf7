#pragma once

#include <functional>
#include <stop_token>
#include <string_view>

namespace armature::sdk {

/// How a caller follows and ends a long call. Both members may be left empty. A call that was asked to stop returns
/// `cancelled()` soon and leaves nothing half-done.
struct Task {
  std::stop_token stop = {};  ///< asks for an early end
  /// Told now and then what is being done and how far it has come, in [0, 1] of that stage. Called on the thread that
  /// made the call.
  std::function<void(std::string_view stage, double fraction)> progress = {};

  /// Whether the caller asked to stop. Thread-safe.
  [[nodiscard]] bool stopped() const noexcept { return stop.stop_requested(); }
  /// Tells the caller, if it listens.
  void report(std::string_view stage, double fraction) const {
    if (progress) progress(stage, fraction);
  }
};

}  // namespace armature::sdk
