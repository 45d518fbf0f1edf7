// An emulated V4L2 depth camera: a regular file as its node, memory-mapped buffers in it.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <deque>
#include <fstream>
#include <mutex>
#include <thread>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "firmware_host/backends/freenect.h"
#include "firmware_host/backends/v4l2.h"
#include "firmware_host/control/video_nodes.h"
#include "firmware_host/depth_source.h"
#include "tests/firmware_host/emulated_usb.h"

namespace armature {
namespace {

using namespace std::chrono_literals;

constexpr std::uint32_t kZ16 = V4L2_PIX_FMT_Z16, kY10b = v4l2_fourcc('Y', '1', '0', 'B');
constexpr int kWidth = 64, kHeight = 48;

/// Frame n shows 1000 + n millimetres, or the disparity 300 + n, all over the image.
class EmulatedCamera {
 public:
  EmulatedCamera(test::EmulatedBus& bus, std::uint32_t format, std::string card)
      : bus_(bus), format_(format), card_(std::move(card)), handler_(umockdev_ioctl_base_new()) {
    g_signal_connect(handler_, "handle-ioctl",
                     G_CALLBACK(+[](UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer self) -> gboolean {
                       return static_cast<EmulatedCamera*>(self)->handle(client) ? TRUE : FALSE;
                     }),
                     this);
    umockdev_testbed_attach_ioctl(bus_.testbed(), "/dev/video0", handler_, nullptr);
  }
  ~EmulatedCamera() {
    umockdev_testbed_detach_ioctl(bus_.testbed(), "/dev/video0", nullptr);
    g_object_unref(handler_);
  }
  EmulatedCamera(const EmulatedCamera&) = delete;
  EmulatedCamera& operator=(const EmulatedCamera&) = delete;

  /// As part of another device, or of none.
  void plug_in(const std::string& part_of = "/devices") {
    path_ = part_of + "/video0";
    umockdev_testbed_add_from_string(
        bus_.testbed(), ("P: " + path_ + "\nN: video0=00\nE: SUBSYSTEM=video4linux\nE: DEVNAME=/dev/video0\n").c_str(),
        nullptr);
    gchar* root = umockdev_testbed_get_root_dir(bus_.testbed());
    node_ = std::string(root) + "/dev/video0";
    g_free(root);
    EXPECT_EQ(::truncate(node_.c_str(), static_cast<off_t>(kBuffers * kBufferBytes)), 0);
    const std::lock_guard lock(mutex_);
    gone_ = false;
  }
  void unplug() {
    {
      const std::lock_guard lock(mutex_);
      gone_ = true;
      streaming_ = false;
      queued_.clear();
    }
    umockdev_testbed_remove_device(bus_.testbed(), ("/sys" + path_).c_str());
    ::unlink(node_.c_str());
  }
  /// Takes so long to say what it is.
  void answer_after(std::chrono::milliseconds slowness) {
    const std::lock_guard lock(mutex_);
    slowness_ = slowness;
  }
  void look_at(int depth) {
    const std::lock_guard lock(mutex_);
    depth_ = depth;
  }
  void tear_next() {
    const std::lock_guard lock(mutex_);
    tear_ = true;
  }

 private:
  static constexpr std::size_t kBuffers = 4, kBufferBytes = 8192;

  bool handle(UMockdevIoctlClient* client) {
    const std::lock_guard lock(mutex_);
    const auto complete = [&](int result, int error) {
      umockdev_ioctl_client_complete(client, result, error);
      return true;
    };
    if (gone_) return complete(-1, ENODEV);
    const auto with = [&](auto value, auto fill) {
      using Value = decltype(value);
      UMockdevIoctlData* data =
          umockdev_ioctl_data_resolve(umockdev_ioctl_client_get_arg(client), 0, sizeof(Value), nullptr);
      const int error = fill(*reinterpret_cast<Value*>(data->data));
      complete(error == 0 ? 0 : -1, error);
      umockdev_ioctl_data_unref(data);
      return true;
    };
    switch (umockdev_ioctl_client_get_request(client)) {
      case VIDIOC_QUERYCAP:
        std::this_thread::sleep_for(slowness_);
        return with(v4l2_capability{}, [&](v4l2_capability& c) {
          std::memset(&c, 0, sizeof c);
          std::memcpy(c.card, card_.c_str(), std::min(card_.size(), sizeof c.card - 1));
          std::memcpy(c.bus_info, "usb-1", 5);
          c.capabilities = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
          return 0;
        });
      case VIDIOC_ENUM_FMT:
        return with(v4l2_fmtdesc{}, [&](v4l2_fmtdesc& f) {
          if (f.index > 0) return EINVAL;
          f.pixelformat = format_;
          return 0;
        });
      case VIDIOC_G_FMT:
      case VIDIOC_S_FMT:
        return with(v4l2_format{}, [&](v4l2_format& f) {
          f.fmt.pix.pixelformat = format_;
          f.fmt.pix.width = kWidth;
          f.fmt.pix.height = kHeight;
          f.fmt.pix.bytesperline = format_ == kZ16 ? kWidth * 2 : kWidth * 10 / 8;
          return 0;
        });
      case VIDIOC_G_PARM:
        return with(v4l2_streamparm{}, [&](v4l2_streamparm& p) {
          p.parm.capture.timeperframe = {1, 60};
          return 0;
        });
      case VIDIOC_REQBUFS:
        return with(v4l2_requestbuffers{}, [&](v4l2_requestbuffers& r) {
          r.count = kBuffers;
          return 0;
        });
      case VIDIOC_QUERYBUF:
        return with(v4l2_buffer{}, [&](v4l2_buffer& b) {
          b.length = kBufferBytes;
          b.m.offset = static_cast<__u32>(b.index * kBufferBytes);
          return 0;
        });
      case VIDIOC_QBUF:
        return with(v4l2_buffer{}, [&](v4l2_buffer& b) {
          queued_.push_back(b.index);
          return 0;
        });
      case VIDIOC_DQBUF: return with(v4l2_buffer{}, [&](v4l2_buffer& b) { return dequeue(b); });
      case VIDIOC_STREAMON: streaming_ = true; return complete(0, 0);
      case VIDIOC_STREAMOFF:
        streaming_ = false;
        queued_.clear();
        return complete(0, 0);
      default: return complete(-1, ENOTTY);
    }
  }
  int dequeue(v4l2_buffer& b) {
    const auto now = std::chrono::steady_clock::now();
    if (!streaming_ || queued_.empty() || now < next_) return EAGAIN;
    next_ = now + 16ms;
    b.index = queued_.front();
    queued_.pop_front();
    std::vector<std::uint8_t> image(static_cast<std::size_t>(kHeight) *
                                    (format_ == kZ16 ? kWidth * 2 : kWidth * 10 / 8));
    if (format_ == kZ16) {
      for (std::size_t i = 0; i < image.size(); i += 2) {
        image[i] = static_cast<std::uint8_t>((depth_ + sent_) & 0xFF);
        image[i + 1] = static_cast<std::uint8_t>((depth_ + sent_) >> 8);
      }
    } else {
      for (std::size_t bit = 0; bit < image.size() * 8; ++bit) {
        if (((300 + sent_) >> (9 - bit % 10) & 1) != 0) image[bit / 8] |= static_cast<std::uint8_t>(0x80U >> bit % 8);
      }
    }
    const int file = ::open(node_.c_str(), O_WRONLY);
    if (file < 0 || ::pwrite(file, image.data(), image.size(), static_cast<off_t>(b.index * kBufferBytes)) < 0)
      return EIO;
    ::close(file);
    b.bytesused = static_cast<__u32>(tear_ ? image.size() / 2 : image.size());
    tear_ = false;
    b.sequence = static_cast<__u32>(sent_);
    b.flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
    b.timestamp.tv_sec = 100 + sent_ / 60;
    b.timestamp.tv_usec = sent_ % 60 * 16'666;
    ++sent_;
    return 0;
  }

  test::EmulatedBus& bus_;
  std::uint32_t format_;
  std::string card_, node_, path_;
  UMockdevIoctlBase* handler_;
  std::mutex mutex_;
  std::deque<__u32> queued_;
  bool gone_ = true, streaming_ = false, tear_ = false;
  std::chrono::milliseconds slowness_{0};
  int sent_ = 0;
  int depth_ = 1000;  // of the first image, in the camera's unit
  std::chrono::steady_clock::time_point next_;
};

bool frame_within(DepthSource& source, DepthFrame& frame, std::chrono::milliseconds patience) {
  const auto give_up = std::chrono::steady_clock::now() + patience;
  while (std::chrono::steady_clock::now() < give_up) {
    const auto status = source.read(frame, 100ms);
    if (status && *status == ReadStatus::Frame) return true;
    if (!status) return false;
  }
  return false;
}

class V4l2Test : public testing::Test {
 protected:
  void SetUp() override {
    if (!test::emulation()) GTEST_SKIP() << "needs umockdev-wrapper (tools/setup installs umockdev)";
  }
  test::EmulatedBus bus_;
};

TEST_F(V4l2Test, ACameraOfMillimetresComesWithItsTimeAndItsModelsFocalLength) {
  EmulatedCamera camera(bus_, kZ16, "Intel(R) RealSense(TM) D435");
  camera.plug_in();
  const auto nodes = list_depth_nodes();
  ASSERT_EQ(nodes.size(), 1U);
  EXPECT_EQ(nodes.front().format, "Z16");
  auto source = open_v4l2("/dev/video0", {});
  ASSERT_TRUE(source) << source.error().message;
  EXPECT_NEAR((*source)->info().intrinsics.focal_x_px, 32 / std::tan(87 * M_PI / 360), 1e-6);
  EXPECT_EQ((*source)->info().frames_per_second, 60);
  DepthFrame frame;
  for (std::uint64_t n = 0; n < 10; ++n) {
    ASSERT_TRUE(frame_within(**source, frame, 5s));
    EXPECT_EQ(frame.sequence, n);
    EXPECT_EQ(frame.depth_mm, std::vector<std::uint16_t>(kWidth * kHeight, static_cast<std::uint16_t>(1000 + n)));
    EXPECT_EQ(frame.sensor.time, 100s + n * 16'666us);
    EXPECT_EQ(frame.sensor.clock, ClockId::HostMonotonic);
  }
}

TEST_F(V4l2Test, ACamerasOwnUnitBecomesMillimetres) {
  for (const auto& [name, unit_mm] : {std::pair("Intel RealSense D405", 0.1), std::pair("Intel RealSense SR300", 0.125),
                                      std::pair("Intel RealSense SR305", 0.125)}) {
    EmulatedCamera camera(bus_, kZ16, name);
    camera.plug_in();
    {
      auto source = open_v4l2("/dev/video0", {});
      ASSERT_TRUE(source) << source.error().message;
      DepthFrame frame;
      ASSERT_TRUE(frame_within(**source, frame, 5s));
      EXPECT_EQ(frame.depth_mm.front(), std::lround(1000 * unit_mm)) << name;
      EXPECT_EQ(frame.depth_mm.back(), frame.depth_mm.front());
    }
    camera.unplug();
  }
}

TEST_F(V4l2Test, ACameraIsResetOverTheUsbThatItIsOn) {
  test::EmulatedKinect kinect(bus_);
  kinect.plug_in();
  EmulatedCamera camera(bus_, kY10b, "kinect");
  camera.plug_in("/devices/usb1/1-1");
  {
    auto source = open_v4l2("/dev/video0", {});
    ASSERT_TRUE(source) << source.error().message;
    const auto reset = (*source)->recover(RecoverBy::ResettingDevice);
    EXPECT_TRUE(reset) << reset.error().message;
    EXPECT_EQ(kinect.resets(), 1);
  }
  camera.unplug();
  camera.plug_in();
  auto source = open_v4l2("/dev/video0", {});
  ASSERT_TRUE(source) << source.error().message;
  EXPECT_FALSE((*source)->recover(RecoverBy::ResettingDevice)) << "it is on no USB";
}

TEST_F(V4l2Test, WhatIsFartherThanTenMetresIsNotSeen) {
  EmulatedCamera camera(bus_, kZ16, "D435");
  camera.look_at(9999);
  camera.plug_in();
  auto source = open_v4l2("/dev/video0", {});
  ASSERT_TRUE(source) << source.error().message;
  DepthFrame frame;
  for (const int depth : {9999, 10'000, 0, 0}) {
    ASSERT_TRUE(frame_within(**source, frame, 5s));
    EXPECT_EQ(frame.depth_mm, std::vector<std::uint16_t>(kWidth * kHeight, static_cast<std::uint16_t>(depth)));
  }
}

TEST_F(V4l2Test, ACameraThatOpensSlowlyIsWaitedFor) {
  EmulatedCamera camera(bus_, kZ16, "D435");
  camera.answer_after(2500ms);
  camera.plug_in();
  auto source = open_depth_source("v4l2:/dev/video0", {.wait_for_device = 20s});
  ASSERT_TRUE(source) << source.error().message;
  EXPECT_EQ((*source)->health().restarts, 0U);
}

TEST_F(V4l2Test, TheKinectsKernelDriverSendsPackedDisparities) {
  EmulatedCamera camera(bus_, kY10b, "Xbox NUI Camera");
  camera.plug_in();
  auto source = open_v4l2("/dev/video0", {});
  ASSERT_TRUE(source) << source.error().message;
  EXPECT_NEAR((*source)->info().intrinsics.focal_x_px, 575.8 / 10, 1e-6);
  DepthFrame frame;
  ASSERT_TRUE(frame_within(**source, frame, 5s));
  EXPECT_EQ(frame.depth_mm, std::vector<std::uint16_t>(kWidth * kHeight, kinect_raw_to_mm()[600]));
}

TEST_F(V4l2Test, AModelThatIsNotKnownNeedsItsFocalLength) {
  EmulatedCamera camera(bus_, kZ16, "Somebody's camera");
  camera.plug_in();
  const auto source = open_v4l2("/dev/video0", {});
  ASSERT_FALSE(source);
  EXPECT_NE(source.error().message.find("?focal_px=F"), std::string::npos) << source.error().message;
  EXPECT_TRUE(open_v4l2("/dev/video0?focal_px=60", {}));
  EXPECT_FALSE(open_v4l2("/dev/video0?focal_px=nan", {}));
  EXPECT_FALSE(open_v4l2("/dev/video0?zoom=3", {}));
}

TEST_F(V4l2Test, ATornFrameIsPassedOverAndTheStreamStartsAgain) {
  EmulatedCamera camera(bus_, kZ16, "D435");
  camera.plug_in();
  auto source = open_v4l2("/dev/video0", {});
  ASSERT_TRUE(source) << source.error().message;
  DepthFrame frame;
  camera.tear_next();
  ASSERT_TRUE(frame_within(**source, frame, 5s));
  EXPECT_EQ(frame.sequence, 1U);
  ASSERT_TRUE((*source)->recover(RecoverBy::RestartingStream));
  EXPECT_TRUE(frame_within(**source, frame, 5s));
}

TEST_F(V4l2Test, HotplugUnderAProcessOfItsOwnStopsAndComesBack) {
  EmulatedCamera camera(bus_, kZ16, "D435");
  auto source = open_depth_source("v4l2:/dev/video0", {.wait_for_device = 0ms});
  ASSERT_TRUE(source) << source.error().message;
  DepthFrame frame;
  EXPECT_FALSE(frame_within(**source, frame, 700ms));
  for (int times = 0; times < 2; ++times) {
    camera.plug_in();
    const auto plugged = std::chrono::steady_clock::now();
    ASSERT_TRUE(frame_within(**source, frame, 20s)) << (*source)->health().trouble;
    std::printf("frames %.2f s after it was plugged in\n",
                std::chrono::duration<double>(std::chrono::steady_clock::now() - plugged).count());
    camera.unplug();
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

}  // namespace
}  // namespace armature
