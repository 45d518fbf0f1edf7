#include "firmware_host/recording/oni_layout.h"

#include <gtest/gtest.h>

#include "firmware_host/recording/depth_codec.h"
#include "tests/firmware_host/oni_bytes.h"

namespace armature {
namespace {

using test::OniBytes;
using test::small_recording;

void expect_error(const OniBytes& file, const std::string& part) {
  EXPECT_NE(file.error().find(part), std::string::npos) << "expected: " << part << "\nfound: " << file.error();
}

TEST(OniLayout, ReadsASmallRecording) {
  const OniBytes file = small_recording();
  const auto layout = file.layout();
  ASSERT_TRUE(layout) << layout.error().message;
  EXPECT_EQ(layout->width, 4);
  EXPECT_EQ(layout->height, 2);
  EXPECT_EQ(layout->frames_per_second, 30);
  EXPECT_DOUBLE_EQ(layout->horizontal_fov_rad, 1.02);
  EXPECT_EQ(layout->codec, DepthCodec::Raw);
  ASSERT_EQ(layout->frames.size(), 2U);
  EXPECT_EQ(layout->frames[1].index, 2U);
  EXPECT_EQ(layout->frames[1].timestamp_us, 100'000U);
  EXPECT_EQ(layout->frames[1].payload_bytes, 16U);
  EXPECT_EQ(file.bytes[layout->frames[1].payload_offset], '\xe8');
}

TEST(OniLayout, RefusesEveryTruncatedPrefix) {
  const OniBytes file = small_recording();
  for (std::size_t length = 0; length < file.bytes.size(); ++length) {
    const auto layout = OniBytes::layout_of(file.bytes.substr(0, length));
    ASSERT_FALSE(layout) << length;
    EXPECT_NE(layout.error().message.find(length < 4 ? "not an ONI recording" : "truncated recording"),
              std::string::npos)
        << length << ": " << layout.error().message;
  }
}

TEST(OniLayout, SaysWhatItFoundInsteadOfARecording) {
  OniBytes file = small_recording();
  file.bytes.replace(0, 4, "\x89PNG");
  EXPECT_EQ(file.error(), "a.oni: not an ONI recording: expected 'NI10' at byte 0, found '\\x89PNG'");
  file.bytes.clear();
  EXPECT_EQ(file.error(), "a.oni: not an ONI recording: the file is empty");
  file = small_recording();
  file.bytes[5] = '\x07';
  expect_error(file, "recording format 1.7.1.0: expected 1.0.1.0");
}

TEST(OniLayout, RefusesZeroAndAbsurdResolutions) {
  for (const auto& [width, height] : std::vector<std::pair<std::uint32_t, std::uint32_t>>{
           {0, 240}, {320, 0}, {0, 0}, {4097, 1}, {1, 4097}, {4096, 4096}, {0xffffffff, 0xffffffff}, {0x80000000, 2}}) {
    OniBytes file;
    file.depth_stream(width, height, 1).frame(1, 0, "abcd").end();
    expect_error(file, "resolution " + std::to_string(width) + " x " + std::to_string(height));
  }
}

TEST(OniLayout, CountsOnlyWhatIsThere) {
  OniBytes file;
  file.depth_stream(4, 2, 5).end();
  expect_error(file, "holds no depth images");
  expect_error(OniBytes().end(), "holds no depth stream");
}

TEST(OniLayout, RefusesStructuresThatOpenNI2sPlayerWouldTrust) {
  const std::string image(16, 'x');
  expect_error(OniBytes().depth_stream(4, 2, 1).frame(2, 0, image).end(), "image number 2 after 0 of 1");
  expect_error(OniBytes().depth_stream(4, 2, 2).frame(1, 0, image).frame(1, 1, image).end(), "image number 1 after 1");
  expect_error(OniBytes().depth_stream(4, 2, 1).frame(0, 0, image).end(), "image number 0");
  expect_error(OniBytes().depth_stream(4, 2, 1).frame(1, 0, "").end(), "an empty image");
  expect_error(OniBytes().depth_stream(4, 2, 1).frame(1, std::uint64_t{1} << 62, image).end(),
               "later than the recording");
  expect_error(OniBytes().frame(1, 0, image).end(), "node 1, which was not added");
  expect_error(OniBytes().depth_stream(4, 2, 1).frame(1, 0, image, 7).end(), "node 7 is not one of the file's");
  expect_error(OniBytes(0x7fffffff).depth_stream(4, 2, 1).end(), "2147483647 nodes announced");
  expect_error(OniBytes().node(1, "Depth", 2, "NONE", 1).mode(4, 2).cropping().frame(1, 0, image).end(),
               "an image before its stream began");
  expect_error(OniBytes().node(1, "Depth", 2, "NONE", 1).end(), "the file ends before its streams begin");
  expect_error(OniBytes().node(1, "Depth", 2, "NONE", 1).begin().end(), "starts without its resolution");
  expect_error(OniBytes().node(1, "Depth", 2, "NONE", 1).mode(4, 2).begin().end(), "starts without its resolution");
  expect_error(OniBytes().node(1, "Depth", 2, "16zT", 1).mode(4, 2).cropping().begin().end(),
               "starts without its resolution, cropping and largest depth");
  expect_error(OniBytes().depth_stream(4, 2, 1).node(1, "Depth", 2, "NONE", 1).end(), "added twice");
  expect_error(OniBytes(2).depth_stream(4, 2, 1).node(2, "More", 2, "NONE", 1).end(), "two depth streams");
  expect_error(OniBytes(2).depth_stream(4, 2, 1).node(2, "Image", 3, "JPEG", 1).end(), "'Image' is compressed");
  expect_error(OniBytes().node(1, "Depth", 2, "Im8z", 1).end(), "unknown codec");
  expect_error(OniBytes().node(1, "Depth", 9, "NONE", 1).end(), "unknown type 9");
  expect_error(OniBytes().node(1, std::string(200, 'n'), 2, "NONE", 1).end(), "a node without its name");
  expect_error(OniBytes().node(1, "D\xc3\xa9pth", 2, "NONE", 1).end(), "a node without its name");
  expect_error(OniBytes().node(1, "Depth", 2, "NONE", 1, 24).depth_stream(4, 2, 1).end(), "added twice");
  OniBytes seek;
  seek.node(1, "Depth", 2, "NONE", 1, 24).mode(4, 2).cropping().begin().frame(1, 0, image).end();
  expect_error(seek, "the seek table of stream 'Depth' is not where the file says");
}

TEST(OniLayout, RefusesPropertiesOfTheWrongShape) {
  const auto with = [](OniRecordType type, const std::string& fields) {
    return OniBytes().node(1, "Depth", 2, "NONE", 1).record(type, 1, fields);
  };
  const auto raw = [](auto value) { return OniBytes::raw(value); };
  expect_error(with(OniRecordType::IntProperty, "abc"), "sizes do not add up");
  expect_error(with(OniRecordType::IntProperty, OniBytes::name("x") + raw(std::uint32_t{4}) + "abcd"),
               "a number that is not 8 bytes long");
  expect_error(with(OniRecordType::GeneralProperty, OniBytes::name("x") + raw(std::uint32_t{400}) + "abcd"),
               "sizes do not add up");
  expect_error(with(OniRecordType::GeneralProperty, raw(std::uint32_t{0xffffffff}) + "abcd"), "sizes do not add up");
  expect_error(with(OniRecordType::GeneralProperty, raw(std::uint32_t{4}) + "abcd" + raw(std::uint32_t{0})),
               "sizes do not add up");  // a name without its end
  expect_error(with(OniRecordType::StringProperty, OniBytes::name("x") + raw(std::uint32_t{2}) + "ab"),
               "a string without its end");
  expect_error(OniBytes().node(1, "Depth", 2, "NONE", 1).general("xnFOV", "short"), "xnFOV has the wrong length");
  expect_error(OniBytes().node(1, "Depth", 2, "NONE", 1).cropping(1), "holds cropped images");
  expect_error(OniBytes().node(1, "Depth", 2, "NONE", 1).integer("oniPixelFormat", 101), "pixel format 101");
  expect_error(OniBytes().node(1, "Depth", 2, "NONE", 1).integer("oniRequiredFrameSize", 1U << 30), "beyond 16 MiB");
  expect_error(OniBytes().depth_stream(4, 2, 1).integer("oniRequiredFrameSize", 8).frame(1, 0, "x").end(),
               "a frame size smaller than the image");
  expect_error(OniBytes().depth_stream(4, 2, 1).mode(8, 2), "changes its resolution");
  expect_error(with(static_cast<OniRecordType>(99), ""), "unknown kind 99");
  expect_error(OniBytes().node(1, "Depth", 2, "NONE", 1).record(OniRecordType::StateReady, 1, "", "payload"),
               "a payload where none belongs");
}

TEST(OniLayout, PassesOverStreamsThatNobodyOpens) {
  OniBytes file(2);
  file.node(2, "Image", 3, "NONE", 1).general("xnMapOutputMode", std::string(12, '\0'), 2);
  file.depth_stream(4, 2, 1).begin(2);
  file.frame(1, 0, std::string(30, 'i'), 2).frame(1, 0, std::string(16, 'd')).end();
  const auto layout = file.layout();
  ASSERT_TRUE(layout) << layout.error().message;
  EXPECT_EQ(layout->frames.size(), 1U);
}

std::vector<std::uint16_t> decoded(DepthCodec codec, const std::vector<unsigned>& bytes, std::size_t pixels) {
  std::vector<std::byte> payload;
  for (const unsigned byte : bytes) payload.push_back(static_cast<std::byte>(byte));
  std::vector<std::uint16_t> depth(pixels, 0xAAAA);
  return decode_depth(codec, payload, depth) ? depth : std::vector<std::uint16_t>{};
}

TEST(DepthCodec, DecodesEveryForm) {
  using Depth = std::vector<std::uint16_t>;
  constexpr auto kDifferences = DepthCodec::Differences;
  EXPECT_EQ(decoded(kDifferences, {0xE8, 0x03}, 1), Depth({1000}));
  EXPECT_EQ(decoded(kDifferences, {0xE8, 0x03, 0x06}, 3), Depth({1000, 1006, 1006}));  // +6, 0
  EXPECT_EQ(decoded(kDifferences, {0xE8, 0x03, 0xCD}, 2), Depth({1000, 994}));         // -6, padding
  EXPECT_EQ(decoded(kDifferences, {0xE8, 0x03, 0xE2}, 5), Depth({1000, 1000, 1000, 1000, 1000}));
  EXPECT_EQ(decoded(kDifferences, {0xE8, 0x03, 0xFF, 0xC0 - 40}, 2), Depth({1000, 1040}));   // seven bits
  EXPECT_EQ(decoded(kDifferences, {0xE8, 0x03, 0xFF, 0x0B, 0xB8}, 2), Depth({1000, 3000}));  // whole
  EXPECT_EQ(decoded(kDifferences, {0xE8, 0x03, 0x5F, 0x0B, 0xB8}, 3), Depth({1000, 1001, 3000}));
  // Table {0, 800, 900}: positions 1, 2, 0.
  EXPECT_EQ(decoded(DepthCodec::TableDifferences, {3, 0, 0, 0, 0x20, 3, 0x84, 3, 1, 0, 0x58}, 3), Depth({800, 900, 0}));
  EXPECT_EQ(decoded(DepthCodec::Raw, {1, 0, 2, 0}, 2), Depth({1, 2}));
}

TEST(DepthCodec, RefusesWhatWouldReadOrWriteTooFar) {
  constexpr auto kDifferences = DepthCodec::Differences;
  EXPECT_TRUE(decoded(kDifferences, {}, 1).empty());
  EXPECT_TRUE(decoded(kDifferences, {0xE8}, 1).empty());
  EXPECT_TRUE(decoded(kDifferences, {0xE8, 0x03}, 2).empty());                        // too few pixels
  EXPECT_TRUE(decoded(kDifferences, {0xE8, 0x03, 0x66}, 2).empty());                  // too many
  EXPECT_TRUE(decoded(kDifferences, {0xE8, 0x03, 0xEF}, 4).empty());                  // a run past the end
  EXPECT_TRUE(decoded(kDifferences, {0xE8, 0x03, 0xFF}, 2).empty());                  // nothing follows
  EXPECT_TRUE(decoded(kDifferences, {0xE8, 0x03, 0xFF, 0x0B}, 2).empty());            // half a value follows
  EXPECT_TRUE(decoded(DepthCodec::TableDifferences, {0, 0, 0, 0}, 1).empty());        // an empty table
  EXPECT_TRUE(decoded(DepthCodec::TableDifferences, {9, 0, 0, 0}, 1).empty());        // a table past the end
  EXPECT_TRUE(decoded(DepthCodec::TableDifferences, {1, 0, 7, 0, 1, 0}, 1).empty());  // a position past the table
  EXPECT_TRUE(decoded(DepthCodec::TableDifferences, {1, 0, 7, 0, 0, 0, 0x0D}, 2).empty());
  EXPECT_TRUE(decoded(DepthCodec::Raw, {1, 0, 2}, 2).empty());
  EXPECT_TRUE(decode_depth(DepthCodec::Raw, {}, {}));  // nothing at all is no image, but no harm either
}

}  // namespace
}  // namespace armature
