#include "tracker/daemon/capture.h"

namespace armature {

using namespace std::chrono_literals;

Capture::Capture(std::unique_ptr<DepthSource> source, bool lossless) : source_(std::move(source)), lossless_(lossless) {
  if (!lossless_) thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

void Capture::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    const auto status = source_->read(latest_.slot(), 100ms);
    if (!status) failure_ = status.error();
    if (!status || *status == ReadStatus::EndOfStream) break;
    if (*status == ReadStatus::Frame) latest_.publish();
  }
  latest_.close();  // failure_ was written before and is read after
}

const DepthFrame* Capture::next(std::chrono::milliseconds timeout) {
  if (!lossless_) return latest_.take(timeout);
  if (over_) return nullptr;
  const auto status = source_->read(frame_, timeout);
  if (!status) failure_ = status.error();
  over_ = !status || *status == ReadStatus::EndOfStream;
  return status && *status == ReadStatus::Frame ? &frame_ : nullptr;
}

bool Capture::finished() const noexcept {
  return lossless_ ? over_ : latest_.finished();
}

}  // namespace armature
