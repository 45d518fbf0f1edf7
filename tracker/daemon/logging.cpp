#include "tracker/daemon/logging.h"

#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <string_view>

#include <fmt/format.h>
#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <sys/stat.h>
#include <systemd/sd-daemon.h>

namespace armature {
namespace {

/// Whether what is written to stderr goes to the journal, by its device and inode: one that was inherited and led
/// elsewhere does not.
bool stderr_is_journal() {
  const char* stream = std::getenv("JOURNAL_STREAM");
  struct stat about {};
  return stream != nullptr && ::fstat(STDERR_FILENO, &about) == 0 &&
         fmt::format("{}:{}", about.st_dev, about.st_ino) == stream;
}

/// The priority of a line, as the journal takes it off again.
class Priority final : public spdlog::custom_flag_formatter {
 public:
  void format(const spdlog::details::log_msg& message, const std::tm&, spdlog::memory_buf_t& out) override {
    const std::string_view prefix = message.level >= spdlog::level::err    ? SD_ERR
                                    : message.level >= spdlog::level::warn ? SD_WARNING
                                                                           : SD_INFO;
    out.append(prefix.data(), prefix.data() + prefix.size());
  }
  [[nodiscard]] std::unique_ptr<custom_flag_formatter> clone() const override { return std::make_unique<Priority>(); }
};

}  // namespace

void log_to_stderr(bool quiet) {
  spdlog::set_default_logger(spdlog::stderr_color_mt("armatured"));
  if (stderr_is_journal()) {
    auto lines = std::make_unique<spdlog::pattern_formatter>();
    lines->add_flag<Priority>('*').set_pattern("%*%v");
    spdlog::set_formatter(std::move(lines));
  } else {
    spdlog::set_pattern("%H:%M:%S.%e %n: %v");
  }
  if (quiet) spdlog::set_level(spdlog::level::err);
}

void log_failure(const char* why) {
  std::fprintf(stderr, "%s%s\n", stderr_is_journal() ? SD_ERR : "armatured: ", why);
}

}  // namespace armature
