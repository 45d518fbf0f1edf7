#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include <armature/sdk/error.h>
#include <armature/sdk/task.h>

namespace armature::viewer {

/// What becomes of work that somebody cancels.
enum class Stops : std::uint8_t {
  Anywhere,  ///< nothing: what it hands back is dropped
  ByItself,  ///< it changes things as it goes on, and puts them back where it ends as a failure of kind Cancelled
  Never,     ///< the same, but it can only be done
};

/// How far a job has come.
struct JobProgress {
  std::string stage;    ///< as the sdk names it
  double fraction = 0;  ///< of that stage
};

/// Work on a thread of its own, one at a time. Work gets no access to what is shown: it returns a function that makes
/// the changes, which `poll()` calls on the caller's thread, all or none of it.
class Job {
 public:
  using Apply = std::function<void()>;
  using Work = std::function<sdk::Expected<Apply>(const sdk::Task&)>;

  Job() = default;
  /// Cancels and waits.
  ~Job();
  Job(const Job&) = delete;
  Job& operator=(const Job&) = delete;

  [[nodiscard]] bool running() const noexcept { return state_ != nullptr; }
  [[nodiscard]] const std::string& title() const noexcept { return title_; }
  /// Whether it is work that cannot be cancelled.
  [[nodiscard]] bool whole() const noexcept { return stops_ == Stops::Never; }
  /// Whether it has been cancelled and has not ended yet.
  [[nodiscard]] bool stopping() const { return running() && thread_.get_stop_token().stop_requested(); }
  [[nodiscard]] JobProgress progress() const;

  /// None may be running.
  void start(std::string title, Work work, Stops stops = Stops::Anywhere);
  /// Asks the work to stop, which then ends as a failure of kind Cancelled, unless it is whole, or stops by itself and
  /// was done before.
  void cancel();
  /// Once the work has ended: applies its changes, or tells why there are none. Nothing while it runs.
  [[nodiscard]] std::optional<sdk::Expected<void>> poll();
  /// The same for whom only a failure matters: what is wrong, if the work has just failed and was not cancelled.
  [[nodiscard]] std::optional<std::string> poll_failure();

 private:
  struct State {
    std::mutex mutex;
    JobProgress progress;
    std::optional<sdk::Expected<Apply>> result;
  };
  std::string title_;
  Stops stops_ = Stops::Anywhere;
  std::shared_ptr<State> state_;  // or none
  std::jthread thread_;
};

}  // namespace armature::viewer
