#include "viewer/session/job.h"

#include <new>
#include <stdexcept>
#include <utility>

namespace armature::viewer {

Job::~Job() {
  cancel();
}

void Job::start(std::string title, Work work, Stops stops) {
  title_ = std::move(title);
  stops_ = stops;
  state_ = std::make_shared<State>();
  thread_ = std::jthread([state = state_, work = std::move(work)](const std::stop_token& stop) {
    const sdk::Task task{.stop = stop, .progress = [&](std::string_view stage, double fraction) {
                           const std::lock_guard lock(state->mutex);
                           state->progress = {std::string(stage), fraction};
                         }};
    sdk::Expected<Apply> result = sdk::fail("not enough memory for this; close other models and try again");
    try {
      result = work(task);
    } catch (const std::bad_alloc&) {  // the message is there already
    } catch (const std::length_error&) {
    } catch (const std::exception& error) {
      result = sdk::fail(std::string("this went wrong: ") + error.what());
    }
    const std::lock_guard lock(state->mutex);
    state->result = std::move(result);
  });
}

JobProgress Job::progress() const {
  if (!state_) return {};
  const std::lock_guard lock(state_->mutex);
  return state_->progress;
}

void Job::cancel() {
  thread_.request_stop();
}

std::optional<sdk::Expected<void>> Job::poll() {
  if (!state_) return std::nullopt;
  {
    const std::lock_guard lock(state_->mutex);
    if (!state_->result) return std::nullopt;
  }
  const bool cancelled = stops_ == Stops::Anywhere && thread_.get_stop_token().stop_requested();
  thread_.join();
  const sdk::Expected<Apply> result = std::move(*std::exchange(state_, nullptr)->result);
  if (cancelled) return sdk::cancelled();  // also where the work was done before it could notice
  if (!result) return tl::unexpected(result.error());
  if (*result) (*result)();
  return sdk::Expected<void>();
}

std::optional<std::string> Job::poll_failure() {
  const auto done = poll();
  if (!done || *done || done->error().kind == sdk::ErrorKind::Cancelled) return std::nullopt;
  return done->error().message;
}

}  // namespace armature::viewer
