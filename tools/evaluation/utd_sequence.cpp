#include "tools/evaluation/utd_sequence.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <sstream>
#include <system_error>

#include <zstd.h>

namespace armature::tools {
namespace {

constexpr int kWidth = 320, kHeight = 240;
constexpr std::size_t kPixels = static_cast<std::size_t>(kWidth) * kHeight;
constexpr unsigned long long kMaxBytes = 1ULL << 30U;
constexpr std::string_view kDepthEnding = ".u16.zst";

Expected<std::vector<char>> read_whole(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return fail(path.string() + ": cannot be read");
  return std::vector<char>{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

Expected<std::vector<std::uint16_t>> read_depth(const std::filesystem::path& path) {
  const auto packed = read_whole(path);
  if (!packed) return tl::unexpected(packed.error());
  const unsigned long long size = ZSTD_getFrameContentSize(packed->data(), packed->size());
  if (size > kMaxBytes || size % (2 * kPixels) != 0) {
    return fail(path.string() + ": expected zstd of whole frames of 320x240 uint16");
  }
  std::vector<std::uint8_t> bytes(size);
  const std::size_t unpacked = ZSTD_decompress(bytes.data(), bytes.size(), packed->data(), packed->size());
  if (ZSTD_isError(unpacked) != 0 || unpacked != size) return fail(path.string() + ": damaged zstd data");
  std::vector<std::uint16_t> depth(size / 2);
  for (std::size_t i = 0; i < depth.size(); ++i) {
    depth[i] = static_cast<std::uint16_t>(bytes[2 * i] | bytes[2 * i + 1] << 8U);
  }
  return depth;
}

Expected<std::vector<SdkJoints>> read_joints(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file) return fail(path.string() + ": cannot be read");
  std::vector<SdkJoints> rows;
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream numbers(line);
    float value = 0;
    numbers >> value;
    SdkJoints joints;
    for (Eigen::Vector3f& joint : joints) numbers >> joint.x() >> joint.y() >> joint.z();
    if (!numbers) {
      return fail(path.string() + ": line " + std::to_string(rows.size() + 2) + ": expected 61 numbers");
    }
    rows.push_back(joints);
  }
  return rows;
}

}  // namespace

std::span<const std::uint16_t> UtdSequence::frame(std::size_t i) const noexcept {
  return std::span(depth_mm).subspan(i * kPixels, kPixels);
}

Expected<std::vector<std::string>> list_utd_sequences(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  std::error_code failed;
  for (const auto& entry : std::filesystem::directory_iterator(folder, failed)) {
    const std::string name = entry.path().filename().string();
    if (name.ends_with(kDepthEnding)) names.push_back(name.substr(0, name.size() - kDepthEnding.size()));
  }
  if (failed) return fail(folder.string() + ": cannot be listed: " + failed.message());
  if (names.empty()) return fail(folder.string() + ": no recordings *.u16.zst in this folder");
  std::sort(names.begin(), names.end());
  return names;
}

Expected<UtdSequence> read_utd_sequence(const std::filesystem::path& folder, const std::string& name) {
  auto depth = read_depth(folder / (name + std::string(kDepthEnding)));
  if (!depth) return tl::unexpected(depth.error());
  auto joints = read_joints(folder / (name + ".joints.csv"));
  if (!joints) return tl::unexpected(joints.error());
  if (joints->size() != depth->size() / kPixels) {
    return fail((folder / name).string() + ": " + std::to_string(depth->size() / kPixels) + " frames but joints for " +
                std::to_string(joints->size()));
  }
  UtdSequence sequence;
  sequence.name = name;
  char letter = 0;
  if (!(std::istringstream(name) >> letter >> sequence.action >> letter >> letter >> sequence.person)) {
    return fail((folder / name).string() + ": a recording's name says action, subject and trial, as in a1_s1_t1");
  }
  sequence.intrinsics = {kWidth, kHeight, 285.63, 285.63, 160, 120};
  sequence.depth_mm = std::move(*depth);
  sequence.joints = std::move(*joints);
  return sequence;
}

}  // namespace armature::tools
