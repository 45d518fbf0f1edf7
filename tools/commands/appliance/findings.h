#pragma once

#include <cstdio>
#include <string>

#include "tools/json_lines.h"

namespace armature::tools {

/// What was found, line by line.
class Findings {
 public:
  explicit Findings(bool json) : json_(json) {}
  void good(const std::string& what, const std::string& found) { say("ok", what, found, ""); }
  void note(const std::string& what, const std::string& found) { say("note", what, found, ""); }
  void bad(const std::string& what, const std::string& found, const std::string& remedy) {
    ++problems_;
    say("problem", what, found, remedy);
  }
  [[nodiscard]] int problems() const noexcept { return problems_; }

 private:
  void say(const char* kind, const std::string& what, const std::string& found, const std::string& remedy) const {
    if (json_) {
      (void)write_json_line(stdout, {{"kind", kind}, {"what", what}, {"found", found}, {"remedy", remedy}});
      return;
    }
    std::printf("%-8s %-12s %s%s%s\n", kind, what.c_str(), found.c_str(), remedy.empty() ? "" : "\n         -> ",
                remedy.c_str());
  }
  bool json_;
  int problems_ = 0;
};

}  // namespace armature::tools
