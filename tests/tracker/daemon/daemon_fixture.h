#pragma once

#include <chrono>
#include <string>
#include <thread>

#include <gtest/gtest.h>

#include "tests/support/temporary_directory.h"
#include "tracker/daemon/daemon.h"

namespace armature {

using namespace std::chrono_literals;

/// Spins until `done` or ten seconds are over: a bound for hanging, not a measure of speed.
template <class Done>
bool eventually(Done done) {
  const auto give_up = std::chrono::steady_clock::now() + 10s;
  while (!done()) {
    if (std::chrono::steady_clock::now() > give_up) return false;
    std::this_thread::sleep_for(5ms);
  }
  return true;
}

class DaemonTest : public testing::Test {
 protected:
  DaemonOptions options_for(const std::string& source, bool lossless = false) {
    DaemonOptions options;
    options.config.source = source;
    options.config.endpoint = endpoint_;
    options.config.lossless = lossless;
    options.config.tracker.rest.mode = RestMode::Auto;
    options.override_config = [source, endpoint = endpoint_](Config& config) {
      config.source = source;
      config.endpoint = endpoint;
    };
    return options;
  }
  test::TemporaryDirectory directory_;
  std::string endpoint_ = "ipc://" + (directory_.path() / "nav").string();
};

}  // namespace armature
