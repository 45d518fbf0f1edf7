#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <utility>

#include <armature/sdk/error.h>
#include <armature/sdk/task.h>

namespace armature::viewer {

/// Something that takes long to make: made by the thread that asks for it first, while others that ask wait for it.
/// Thread-safe.
template <class T>
class MadeOnce {
 public:
  /// Made by `make(task)`, which returns an `sdk::Expected<T>`, unless it is there. Where making it fails or is
  /// cancelled, who asks next makes it. Cancelled where `task` is stopped while it waits.
  template <class Make>
  [[nodiscard]] sdk::Expected<std::shared_ptr<const T>> get(const sdk::Task& task, const Make& make) {
    {
      std::unique_lock lock(mutex_);
      if (!changed_.wait(lock, task.stop, [&] { return !making_; })) return sdk::cancelled();
      if (made_) return made_;
      making_ = true;
    }
    const Turn turn(*this);
    auto made = make(task);
    if (!made) return tl::unexpected(made.error());
    auto shared = std::make_shared<const T>(std::move(*made));
    const std::lock_guard lock(mutex_);
    return made_ = std::move(shared);
  }

 private:
  /// Ends, whatever happens, with the next one's.
  struct Turn {
    explicit Turn(MadeOnce& maker) : of(maker) {}
    Turn(const Turn&) = delete;
    Turn& operator=(const Turn&) = delete;
    ~Turn() {
      const std::lock_guard lock(of.mutex_);
      of.making_ = false;
      of.changed_.notify_all();
    }
    MadeOnce& of;
  };

  std::mutex mutex_;
  std::condition_variable_any changed_;
  bool making_ = false;
  std::shared_ptr<const T> made_;
};

}  // namespace armature::viewer
