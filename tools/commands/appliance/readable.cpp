#include "tools/commands/appliance/readable.h"

#include <array>

#include <grp.h>
#include <pwd.h>
#include <sys/wait.h>
#include <unistd.h>

namespace armature::tools {

std::vector<std::string> unreadable_by(const std::string& user, const std::vector<std::string>& files) {
  const passwd* account = ::geteuid() == 0 ? ::getpwnam(user.c_str()) : nullptr;
  if (account == nullptr) return {};
  const uid_t uid = account->pw_uid;
  const gid_t gid = account->pw_gid;
  std::array<gid_t, 64> groups{};
  int count = static_cast<int>(groups.size());
  if (::getgrouplist(user.c_str(), gid, groups.data(), &count) < 0) return {};
  std::vector<std::string> unreadable;
  for (const std::string& file : files) {
    const pid_t child = ::fork();
    if (child == 0) {
      const bool changed =
          ::setgroups(static_cast<std::size_t>(count), groups.data()) == 0 && ::setgid(gid) == 0 && ::setuid(uid) == 0;
      ::_exit(changed && ::access(file.c_str(), R_OK) != 0 ? 1 : 0);
    }
    int status = 0;
    if (child > 0 && ::waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 1)
      unreadable.push_back(file);
  }
  return unreadable;
}

}  // namespace armature::tools
