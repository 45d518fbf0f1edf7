#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include <armature/navproto/error.h>

namespace armature::viewer {

/// A daemon of our own, `armatured`, which ends with this object or with this process.
class DaemonProcess {
 public:
  /// Starts the program that lies beside this one, or in `programs` if that is given. It publishes to `endpoint()`, in
  /// a private folder, with the settings of armature/viewer.toml of the user's configuration where somebody has kept
  /// some there. Fails where the program is not there or cannot be started.
  [[nodiscard]] static navproto::Expected<DaemonProcess> start(const std::string& source,
                                                               const std::filesystem::path& programs = {});
  DaemonProcess(DaemonProcess&& other) noexcept;
  DaemonProcess& operator=(DaemonProcess&& other) noexcept;
  ~DaemonProcess();

  [[nodiscard]] const std::string& endpoint() const noexcept { return endpoint_; }
  [[nodiscard]] const std::string& source() const noexcept { return source_; }
  /// Keeps what the daemon has saved, for the next time; where that is.
  [[nodiscard]] navproto::Expected<std::filesystem::path> keep_settings() const;
  /// False once it has ended.
  [[nodiscard]] bool running();
  /// The last line that it wrote before it ended, without a time. It names the settings by the file that somebody
  /// keeps, if there is one.
  [[nodiscard]] std::string last_words() const;

 private:
  DaemonProcess() = default;
  void end();

  int process_ = -1;
  std::string endpoint_, source_;
  std::filesystem::path folder_;
};

}  // namespace armature::viewer
