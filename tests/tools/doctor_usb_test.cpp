// `armature doctor` and `armature devices` beside an emulated Kinect, as an operator calls them.

#include <array>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "firmware_host/control/video_nodes.h"
#include "tests/firmware_host/emulated_usb.h"
#include "tests/support/temporary_directory.h"

namespace armature {
namespace {

using Lines = std::vector<nlohmann::json>;

/// What `armature WORDS --json` prints, a line an object. `as`: words before it.
Lines armature(const std::string& words, const std::string& as = "") {
  struct Close {
    void operator()(std::FILE* pipe) const noexcept { ::pclose(pipe); }
  };
  const std::string command = as + " " ARMATURE_BINARY_DIR "/bin/armature " + words + " --json 2>/dev/null";
  const std::unique_ptr<std::FILE, Close> pipe(::popen(command.c_str(), "r"));
  EXPECT_TRUE(pipe) << command;
  if (!pipe) return {};
  std::string printed;
  std::array<char, 4096> some{};
  for (std::size_t got = 1; got > 0;) {
    got = std::fread(some.data(), 1, some.size(), pipe.get());
    printed.append(some.data(), got);
  }
  Lines lines;
  std::istringstream text(printed);
  for (std::string line; std::getline(text, line);) lines.push_back(nlohmann::json::parse(line));
  return lines;
}

/// What is said of `what` in a finding of this kind that speaks of `about`; empty where there is none.
std::string said(const Lines& findings, const std::string& kind, const std::string& what, const std::string& about) {
  for (const auto& finding : findings) {
    const std::string found = finding.at("found");
    if (finding.at("kind") == kind && finding.at("what") == what && found.find(about) != std::string::npos)
      return found;
  }
  return "";
}

/// What is said to whom only her own programs are shown.
constexpr std::string_view kNobodySeen =
    ": no program of yours holds it; as root (`sudo armature doctor`) all can be seen";

class DoctorTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!test::emulation()) GTEST_SKIP() << "needs umockdev-wrapper (tools/setup installs umockdev)";
  }
  test::EmulatedBus bus_;
  test::EmulatedKinect kinect_{bus_};
};

TEST_F(DoctorTest, SaysThatNoSensorIsPluggedIn) {
  EXPECT_TRUE(armature("devices").empty());
  EXPECT_NE(said(armature("doctor"), "problem", "sensor", "no depth sensor is plugged in"), "");
}

TEST_F(DoctorTest, FindsNothingWrongWithAKinectThatIsFree) {
  kinect_.plug_in();
  const Lines devices = armature("devices");
  ASSERT_EQ(devices.size(), 1U);
  EXPECT_EQ(devices.front().at("uri"), "freenect:0");
  EXPECT_EQ(devices.front().at("serial"), "A00362912345678A");
  const Lines findings = armature("doctor");
  const bool root = ::geteuid() == 0;
  EXPECT_EQ(said(findings, root ? "ok" : "note", "sensor", "Kinect v1"),
            "Kinect v1 on port 1-1" + (root ? " is free" : std::string(kNobodySeen)));
  for (const char* what : {"usb", "permission", "bandwidth", "power", "sensor"})
    EXPECT_EQ(said(findings, "problem", what, ""), "");
}

/// Words to be somebody by who is not root. She may look into the emulated /dev, but open its USB nodes only if said
/// so.
std::string as_nobody(UMockdevTestbed* testbed, bool may_open = false) {
  namespace fs = std::filesystem;
  const std::unique_ptr<char, decltype(&g_free)> root(umockdev_testbed_get_root_dir(testbed), &g_free);
  const auto let_in = [](const fs::path& path) { fs::permissions(path, fs::perms(0777), fs::perm_options::add); };
  let_in(root.get());
  for (const auto& entry : fs::recursive_directory_iterator(root.get())) {
    if (!entry.is_symlink()) let_in(entry.path());
  }
  for (const auto& node : fs::recursive_directory_iterator(fs::path(root.get()) / "dev/bus/usb")) {
    if (!node.is_directory() && !may_open) fs::permissions(node.path(), fs::perms(0077), fs::perm_options::remove);
  }
  return "setpriv --reuid 65534 --regid 65534 --clear-groups";
}

TEST_F(DoctorTest, SaysOfOtherUsersProgramsOnlyWhatItSees) {
  if (::geteuid() != 0) GTEST_SKIP() << "needs root, to become somebody else";
  kinect_.plug_in();
  EXPECT_NE(said(armature("doctor", as_nobody(bus_.testbed())), "problem", "permission", "Kinect v1"), "");
  const Lines findings = armature("doctor", as_nobody(bus_.testbed(), true));
  EXPECT_EQ(said(findings, "note", "sensor", "Kinect v1"), "Kinect v1 on port 1-1" + std::string(kNobodySeen));
  EXPECT_EQ(said(findings, "ok", "sensor", ""), "");
}

TEST_F(DoctorTest, ARealSenseNeedsItsVideoNodeOnly) {
  // A D435: as much of its descriptors as it is known by.
  GError* error = nullptr;
  ASSERT_TRUE(umockdev_testbed_add_from_string(bus_.testbed(),
                                               "P: /devices/usb1/1-2\nN: bus/usb/001/002\nE: SUBSYSTEM=usb\n"
                                               "E: DRIVER=usb\nE: BUSNUM=001\nE: DEVNUM=002\n"
                                               "E: DEVNAME=/dev/bus/usb/001/002\nE: DEVTYPE=usb_device\n"
                                               "A: bConfigurationValue=1\\n\nA: busnum=1\\n\nA: devnum=2\\n\n"
                                               "A: speed=5000\\n\n"
                                               "H: descriptors=12010002000000408680070b010201030001"
                                               "09021200010100c0320904000000ffffff00\n",
                                               &error))
      << error->message;
  const std::string nobody = ::geteuid() == 0 ? as_nobody(bus_.testbed()) : "";
  const Lines devices = armature("devices", nobody);
  ASSERT_EQ(devices.size(), 1U);
  EXPECT_EQ(devices.front().at("problem"), "");
  const Lines findings = armature("doctor", nobody);
  EXPECT_EQ(said(findings, "problem", "permission", ""), "");
  EXPECT_EQ(said(findings, "problem", "sensor", ""), "Intel RealSense D435 on port 1-2 has no node in /dev/video*");
}

TEST_F(DoctorTest, SaysThatThePortIsTooSlow) {
  kinect_.plug_in();
  umockdev_testbed_set_attribute(bus_.testbed(), "/sys/devices/usb1/1-1", "speed", "12\n");
  EXPECT_EQ(said(armature("doctor"), "problem", "bandwidth", ""), "Kinect v1 on port 1-1: 12 Mbit/s");
}

TEST_F(DoctorTest, SaysThatTheKinectsPowerSupplyIsMissing) {
  kinect_.plug_in();
  kinect_.unplug_power();
  EXPECT_NE(said(armature("doctor"), "problem", "power", "the motor of a Kinect is there"), "");
}

TEST_F(DoctorTest, SaysHowTheSensorStandsThoughItSeesNoFloor) {
  kinect_.plug_in();
  const Lines findings = armature("doctor --site freenect:0 --seconds 0.5");
  EXPECT_EQ(said(findings, "note", "gravity", ""), "by its accelerometer the sensor looks up by 14 degrees");
  EXPECT_NE(said(findings, "problem", "floor", "seen in 0 of"), "");
}

TEST(Busy, AFileIsNamedByWhoHasItOpen) {
  const test::TemporaryDirectory folder;
  const std::string node = folder.path() / "node";
  std::ofstream(node) << "somebody reads this";
  EXPECT_TRUE(who_has_open(node).empty());
  // Says that it has it open, and goes on saying so until nobody listens.
  const auto close = [](std::FILE* pipe) { ::pclose(pipe); };
  const std::unique_ptr<std::FILE, decltype(close)> reader(
      ::popen(("exec 3< '" + node + "'; while echo open; do :; done").c_str(), "r"), close);
  ASSERT_TRUE(reader);
  std::array<char, 16> line{};
  ASSERT_NE(std::fgets(line.data(), line.size(), reader.get()), nullptr);
  const auto programs = who_has_open(node);
  ASSERT_EQ(programs.size(), 1U);
  EXPECT_EQ(programs.front().substr(0, 4), "sh (");
}

}  // namespace
}  // namespace armature
