#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <utility>

#include <armature/sdk/error.h>
#include <armature/sdk/task.h>

#include "firmware_host/error.h"
#include "tools/interrupt.h"
#include "tools/progress.h"

namespace armature::tools {

/// What the sdk returned, with its failure as one of ours.
template <class T>
[[nodiscard]] Expected<T> ours(sdk::Expected<T> result) {
  return std::move(result).map_error([](sdk::Error&& error) { return Error{std::move(error.message)}; });
}

/// Shows on stderr how far calls of the sdk have come, stage by stage, and lets Ctrl-C end them. A stage that is over
/// within a second shows nothing. One at a time in a process; call from one thread.
class SdkCall {
 public:
  SdkCall() = default;

  /// What to hand to the sdk; valid as long as this is.
  [[nodiscard]] sdk::Task task() {
    return {.stop = interrupt_.token(),
            .progress = [this](std::string_view stage, double fraction) { show(stage, fraction); }};
  }
  [[nodiscard]] bool interrupted() const noexcept { return interrupt_.requested(); }

 private:
  void show(std::string_view stage, double fraction) {
    const auto now = std::chrono::steady_clock::now();
    if (stage != stage_) {
      bar_.reset();
      stage_ = stage;
      began_ = now;
    }
    if (!bar_ && fraction < 1 && now - began_ > std::chrono::seconds(1)) bar_.emplace(ProgressOptions{.title = stage_});
    if (bar_) bar_->update(fraction);
  }

  Interrupt interrupt_;
  std::string stage_;
  std::chrono::steady_clock::time_point began_;
  std::optional<ProgressBar> bar_;
};

}  // namespace armature::tools
