#include "viewer/app/sending.h"

#include <algorithm>
#include <chrono>

namespace armature::viewer {

bool Sending::go_on() {
  constexpr auto kPatience = std::chrono::milliseconds(8);
  const auto start = std::chrono::steady_clock::now();
  while (!drawing_.send_some())
    if (std::chrono::steady_clock::now() - start > kPatience) return false;
  return true;
}

void BackgroundDrawing::rest() {
  making_.cancel();
  static_cast<void>(making_.poll());
  sending_.clear();
}

void BackgroundDrawing::take_made() {
  auto wrong = making_.poll_failure();
  if (!wrong) return;
  complaint_ = std::move(wrong);
  failed_ = true;
}

std::optional<std::vector<Drawing>> BackgroundDrawing::take_sent() {
  if (sending_.empty() || !std::ranges::all_of(sending_, &Sending::go_on)) return std::nullopt;
  std::vector<Drawing> drawings;
  std::vector<std::shared_ptr<const Scene>> scenes;
  for (Sending& sent : sending_) {
    drawings.push_back(sent.take());
    scenes.push_back(sent.scene());
  }
  sending_.clear();
  // Lists of a million triangles take a while to go, too.
  if (!making_.running())
    making_.start("drawing", [scenes = std::move(scenes)](const sdk::Task&) mutable {
      scenes.clear();
      return sdk::Expected<Job::Apply>(Job::Apply());
    });
  return drawings;
}

}  // namespace armature::viewer
