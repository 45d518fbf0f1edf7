// An emulated Kinect v1 on an emulated USB bus, read by the unmodified libfreenect and libusb.

#include <array>
#include <cmath>
#include <thread>

#include <gtest/gtest.h>

#include "firmware_host/backends/freenect.h"
#include "firmware_host/backends/freenect_device.h"
#include "firmware_host/control/usb.h"
#include "firmware_host/depth_source.h"
#include "tests/firmware_host/emulated_usb.h"

namespace armature {
namespace {

using namespace std::chrono_literals;
using test::EmulatedBus;
using test::EmulatedKinect;

class KinectTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!test::emulation()) GTEST_SKIP() << "needs umockdev-wrapper (tools/setup installs umockdev)";
  }
  EmulatedBus bus_;
  EmulatedKinect kinect_{bus_};
};

bool frame_within(DepthSource& source, DepthFrame& frame, std::chrono::milliseconds patience) {
  const auto give_up = std::chrono::steady_clock::now() + patience;
  while (std::chrono::steady_clock::now() < give_up) {
    const auto status = source.read(frame, 100ms);
    if (status && *status == ReadStatus::Frame) return true;
    if (!status) std::this_thread::sleep_for(10ms);
  }
  return false;
}

TEST_F(KinectTest, IsListedByNameSerialAndUri) {
  EXPECT_TRUE(list_usb_sensors()->empty());
  kinect_.plug_in();
  const auto sensors = list_usb_sensors();
  ASSERT_TRUE(sensors) << sensors.error().message;
  ASSERT_EQ(sensors->size(), 1U) << "the motor is no sensor";
  EXPECT_EQ(sensors->front().name, "Kinect v1");
  EXPECT_EQ(sensors->front().uri, "freenect:0");
  EXPECT_EQ(sensors->front().serial, "A00362912345678A");
  EXPECT_EQ(sensors->front().problem, "");
  EXPECT_EQ(sensors->front().speed_mbit, 480);
}

TEST_F(KinectTest, ItsDepthComesInMillimetresWithItsOwnTimeAndFocalLength) {
  kinect_.plug_in();
  auto source = open_freenect_device("0", {});
  ASSERT_TRUE(source) << source.error().message;
  EXPECT_NEAR((*source)->info().intrinsics.focal_x_px, 120 / (2 * 0.1042), 1e-3);
  DepthFrame frame;
  std::chrono::nanoseconds last{-1};
  const auto mm = kinect_raw_to_mm();
  for (int n = 0; n < 5; ++n) {
    ASSERT_TRUE(frame_within(**source, frame, 10s)) << n;
    ASSERT_EQ(frame.depth_mm.size(), 640U * 480);
    const std::uint16_t depth = frame.depth_mm.front();
    EXPECT_EQ(static_cast<std::size_t>(std::count(frame.depth_mm.begin(), frame.depth_mm.end(), depth)),
              frame.depth_mm.size());
    const auto& all = mm;
    EXPECT_NE(std::find_if(all.begin() + 600, all.begin() + 800, [&](auto v) { return std::abs(v - depth) <= 1; }),
              all.begin() + 800)
        << depth;
    EXPECT_EQ(frame.sensor.clock, ClockId::Device);
    if (last.count() >= 0) {
      EXPECT_NEAR(std::chrono::duration<double>(frame.sensor.time - last).count() * 30,
                  std::round(std::chrono::duration<double>(frame.sensor.time - last).count() * 30), 1e-3);
    }
    last = frame.sensor.time;
  }
}

TEST_F(KinectTest, MotorLightAndAccelerometerAnswer) {
  kinect_.plug_in();
  auto motor = KinectMotor::open("0");
  ASSERT_TRUE(motor) << motor.error().message;
  EXPECT_TRUE((*motor)->light(KinectLight::Green));
  EXPECT_EQ(kinect_.light(), 1);
  EXPECT_TRUE((*motor)->tilt(-7.5));
  EXPECT_EQ(kinect_.tilt_half_degrees(), -15);
  EXPECT_FALSE((*motor)->tilt(45));
  const auto posture = (*motor)->posture();
  ASSERT_TRUE(posture) << posture.error().message;
  EXPECT_NEAR(posture->up_m_s2[1], -9.52, 0.01);
  EXPECT_NEAR(posture->up_m_s2[2], 2.37, 0.01);
  EXPECT_EQ(posture->tilt_deg, -7);
}

/// libusb lists them the other way round than their ports and addresses are.
class TwoKinectsTest : public KinectTest {
 protected:
  void SetUp() override {
    KinectTest::SetUp();
    if (IsSkipped()) return;
    one_.plug_in();
    other_.plug_in();
  }
  /// Whose frames `uri` brings.
  EmulatedKinect* read_by(std::string_view which) {
    const auto source = open_freenect_device(which, {});
    EXPECT_TRUE(source) << source.error().message;
    if (!source) return nullptr;
    DepthFrame frame;
    const int before = one_.frames(), others_before = other_.frames();
    EXPECT_TRUE(frame_within(**source, frame, 10s));
    EXPECT_NE(one_.frames() > before, other_.frames() > others_before);
    return one_.frames() > before ? &one_ : &other_;
  }
  EmulatedKinect one_{bus_, 3}, other_{bus_, 4};
};

TEST_F(TwoKinectsTest, ANumberMeansTheSameOneEverywhere) {
  const auto sensors = list_usb_sensors();
  ASSERT_TRUE(sensors) << sensors.error().message;
  ASSERT_EQ(sensors->size(), 2U);
  EXPECT_EQ(sensors->front().uri, "freenect:0");
  EXPECT_EQ(sensors->front().port, "1-3.1");
  EXPECT_EQ(sensors->back().uri, "freenect:1");
  EXPECT_EQ(sensors->back().port, "1-4.1");
  EXPECT_EQ(read_by("0"), &one_);
  EXPECT_EQ(read_by("1"), &other_);
  EXPECT_EQ(read_by("1-3.1"), &one_);
  EXPECT_EQ(read_by("1-4.1"), &other_);
  ASSERT_TRUE(reset_kinect_camera("0"));
  EXPECT_EQ(std::pair(one_.resets(), other_.resets()), std::pair(1, 0));
  const auto& last = sensors->back();
  const std::string as_openni2_names_it = "045e/02ae@" + std::to_string(last.bus) + "/" + std::to_string(last.address);
  EXPECT_EQ(usb_port_of_openni2(as_openni2_names_it), last.port);
  for (const char* none : {"", "045e/02ae", "@", "045e/02ae@1", "045e/02ae@200/200", "/tmp/recording.oni"})
    EXPECT_EQ(usb_port_of_openni2(none), "") << none;
  for (const char* which : {"1", "1-4.1"}) {
    const auto motor = KinectMotor::open(which);
    ASSERT_TRUE(motor) << motor.error().message;
    ASSERT_TRUE((*motor)->light(KinectLight::Red));
    EXPECT_EQ(one_.motor_requests(), 0);
  }
  EXPECT_EQ(other_.light(), 2);
}

TEST_F(TwoKinectsTest, WhatIsOpenIsResetWhoeverComesOrGoes) {
  other_.unplug();
  const auto source = open_freenect_device("0", {});
  ASSERT_TRUE(source) << source.error().message;
  EmulatedKinect newcomer(bus_, 2);
  newcomer.plug_in();
  ASSERT_EQ(list_usb_sensors()->front().port, "1-2.1");
  EXPECT_TRUE((*source)->recover(RecoverBy::ResettingDevice));
  EXPECT_EQ(std::pair(one_.resets(), newcomer.resets()), std::pair(1, 0));
}

TEST_F(TwoKinectsTest, TheMotorOfOneWithoutPowerIsNobodyElses) {
  one_.unplug_power();
  EXPECT_EQ(read_by("0"), &other_);
  const auto motor = KinectMotor::open("0");
  ASSERT_TRUE(motor) << motor.error().message;
  ASSERT_TRUE((*motor)->light(KinectLight::Green));
  EXPECT_EQ(std::pair(one_.light(), other_.light()), std::pair(-1, 1));
  EXPECT_FALSE(KinectMotor::open("1-3.1"));
}

TEST_F(KinectTest, WhatIsNotThereIsNamed) {
  const auto why = [](std::string_view which) { return open_freenect_device(which, {}).error().message; };
  EXPECT_EQ(why("0"), "freenect:0: no Kinect is plugged in; `armature devices` lists what is");
  kinect_.plug_in();
  EXPECT_EQ(why("1"), "freenect:1: only 1 are plugged in; `armature devices` lists what is");
  EXPECT_EQ(why("1-7"), "freenect:1-7: no Kinect is plugged in on port 1-7; `armature devices` lists what is");
  for (const char* which : {"", "x", "1-2x", "+1", "123", "1 "})
    EXPECT_NE(why(which).find(std::string("'freenect:") + which + "': expected freenect:N"), std::string::npos)
        << which;
}

TEST_F(KinectTest, HotplugTellsOfArrivalAndDeparture) {
  std::vector<std::pair<bool, std::uint16_t>> heard;
  auto watch = UsbWatch::start([&](bool in, std::uint16_t, std::uint16_t product) { heard.emplace_back(in, product); });
  ASSERT_TRUE(watch) << watch.error().message;
  const auto wait_for = [&](std::size_t count) {
    for (int i = 0; i < 50 && heard.size() < count; ++i) (*watch)->wait(100ms);
    return heard.size() == count;
  };
  kinect_.plug_in();
  EXPECT_TRUE(wait_for(1));
  kinect_.unplug();
  EXPECT_TRUE(wait_for(2));
  EXPECT_EQ(heard, (std::vector<std::pair<bool, std::uint16_t>>{{true, 0x02ae}, {false, 0x02ae}}));
}

TEST_F(KinectTest, HotplugUnderAProcessOfItsOwnStopsAndComesBack) {
  auto source = open_depth_source("freenect:0", {.wait_for_device = 0ms});
  ASSERT_TRUE(source) << source.error().message;
  DepthFrame frame;
  EXPECT_FALSE(frame_within(**source, frame, 1s));
  EXPECT_NE((*source)->health().trouble.find("no Kinect"), std::string::npos) << (*source)->health().trouble;
  for (int times = 0; times < 2; ++times) {
    kinect_.plug_in();
    const auto plugged = std::chrono::steady_clock::now();
    ASSERT_TRUE(frame_within(**source, frame, 20s)) << (*source)->health().trouble;
    std::printf("frames %.2f s after it was plugged in\n",
                std::chrono::duration<double>(std::chrono::steady_clock::now() - plugged).count());
    EXPECT_EQ((*source)->health().trouble, "");
    (*source)->show(StatusLight::Engaged);
    for (int i = 0; i < 100 && kinect_.light() != 1; ++i) (void)frame_within(**source, frame, 50ms);
    EXPECT_EQ(kinect_.light(), 1) << "green while somebody steers";
    kinect_.unplug();
    const auto unplugged = std::chrono::steady_clock::now();
    std::string trouble;
    while (trouble.empty() && std::chrono::steady_clock::now() - unplugged < 10s) {
      (void)(*source)->read(frame, 10ms);
      trouble = (*source)->health().trouble;
    }
    std::printf("said so %.3f s after it was unplugged: %s\n",
                std::chrono::duration<double>(std::chrono::steady_clock::now() - unplugged).count(), trouble.c_str());
    EXPECT_NE(trouble, "");
  }
}

TEST_F(KinectTest, AMotorThatDoesNotAnswerIsAskedOnceAMinuteAndHoldsNothingUp) {
  kinect_.plug_in();
  kinect_.hang_motor(true);
  const auto source = open_freenect_device("0", {});
  ASSERT_TRUE(source) << source.error().message;
  DepthFrame frame;
  (*source)->show(StatusLight::Ready);
  for (int i = 0; i < 1000 && kinect_.motor_requests() == 0; ++i) ASSERT_TRUE(frame_within(**source, frame, 10s));
  for (const StatusLight light : {StatusLight::Trouble, StatusLight::Ready, StatusLight::Trouble, StatusLight::Off}) {
    (*source)->show(light);
    for (int i = 0; i < 10; ++i) ASSERT_TRUE(frame_within(**source, frame, 10s));
  }
  EXPECT_EQ(kinect_.motor_requests(), 1);
}

TEST_F(KinectTest, ItsLightIsOffWhenNobodyReadsIt) {
  kinect_.plug_in();
  {
    auto source = open_depth_source("freenect:0", {.wait_for_device = 20s});
    ASSERT_TRUE(source) << source.error().message;
    (*source)->show(StatusLight::Engaged);
    DepthFrame frame;
    for (int i = 0; i < 100 && kinect_.light() != 1; ++i) (void)frame_within(**source, frame, 50ms);
    ASSERT_EQ(kinect_.light(), 1);
  }
  EXPECT_EQ(kinect_.light(), 0);
}

}  // namespace
}  // namespace armature
