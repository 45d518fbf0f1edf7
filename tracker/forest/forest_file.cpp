// The model file, little-endian throughout:
//   char magic[8]; u32 version; u32 checksum; u64 payload_size;
//   payload: u32 command_size; char command[]; u32 tree_count; the trees, as tree_codec.h has them;
//            u32 layer_count (0: no correction); the layers: u32 inputs, u32 outputs, f32 weights[], f32 bias[]
// The checksum is the CRC-32 of the payload.

#include <bit>
#include <cstring>
#include <fstream>
#include <system_error>

#include "tracker/forest/checksum.h"
#include "tracker/forest/forest.h"
#include "tracker/forest/tree_codec.h"

namespace armature {
namespace {

constexpr std::array<char, 8> kMagic = {'A', 'R', 'M', 'F', 'O', 'R', 'S', 'T'};
constexpr std::uint32_t kVersion = 2;
constexpr std::size_t kHeaderBytes = 24;
constexpr std::uintmax_t kMaxFileBytes = 256U << 20U;

void put_floats(ByteWriter& out, std::span<const float> values) {
  for (const float value : values) out.put(std::bit_cast<std::uint32_t>(value));
}
std::vector<float> get_floats(ByteReader& in, std::size_t count) {
  std::vector<float> values(count);
  for (float& value : values) value = std::bit_cast<float>(in.get<std::uint32_t>());
  return values;
}

void put_correction(ByteWriter& out, const Perceptron* correction) {
  out.put(static_cast<std::uint32_t>(correction != nullptr ? correction->layers().size() : 0));
  if (correction == nullptr) return;
  for (const PerceptronLayer& layer : correction->layers()) {
    out.put(static_cast<std::uint32_t>(layer.inputs));
    out.put(static_cast<std::uint32_t>(layer.outputs));
    put_floats(out, layer.weights);
    put_floats(out, layer.bias);
  }
}

/// The layers of the correction; an error where the bytes end before they do.
Expected<std::vector<PerceptronLayer>> get_layers(ByteReader& in) {
  const auto cut = [] { return fail("it ends in the middle of its correction"); };
  if (in.left() < 4) return cut();
  const auto count = in.get<std::uint32_t>();
  if (count > Perceptron::kMaxLayers) return fail("a correction of " + std::to_string(count) + " layers");
  std::vector<PerceptronLayer> layers(count);
  for (PerceptronLayer& layer : layers) {
    if (in.left() < 8) return cut();
    const std::uint64_t inputs = in.get<std::uint32_t>(), outputs = in.get<std::uint32_t>();
    constexpr std::uint64_t kMost = Perceptron::kMaxWidth;
    if (inputs > kMost || outputs > kMost) return fail("a layer of its correction is too wide");
    if (in.left() < 4 * (inputs + 1) * outputs) return cut();
    layer.inputs = static_cast<int>(inputs);
    layer.outputs = static_cast<int>(outputs);
    layer.weights = get_floats(in, inputs * outputs);
    layer.bias = get_floats(in, outputs);
  }
  return layers;
}

std::vector<std::byte> payload_of(const Forest& forest) {
  ByteWriter out;
  out.put(static_cast<std::uint32_t>(forest.command().size()));
  out.put_text(forest.command());
  out.put(static_cast<std::uint32_t>(forest.trees().size()));
  for (const Tree& tree : forest.trees()) put_tree(out, tree);
  put_correction(out, forest.correction());
  return out.take();
}

Expected<Forest> parse_payload(ByteReader in, const std::string& name) {
  const auto cut = [&] { return fail(name + ": damaged model: it ends in the middle of a tree"); };
  if (in.left() < 8) return cut();
  const auto command_size = in.get<std::uint32_t>();
  if (in.left() < std::uint64_t{command_size} + 4) return cut();
  std::string command = in.get_text(command_size);
  const auto tree_count = in.get<std::uint32_t>();
  if (tree_count == 0 || tree_count > kMaxTrees) {
    return fail(name + ": damaged model: " + std::to_string(tree_count) + " trees, expected 1 to " +
                std::to_string(kMaxTrees));
  }
  std::vector<Tree> trees;
  for (std::uint32_t t = 0; t < tree_count; ++t) {
    auto tree = get_tree(in);
    if (!tree) return cut();
    trees.push_back(std::move(*tree));
  }
  const auto damaged = [&](const Error& error) { return fail(name + ": damaged model: " + error.message); };
  auto layers = get_layers(in);
  if (!layers) return damaged(layers.error());
  if (in.left() != 0) {
    return fail(name + ": damaged model: " + std::to_string(in.left()) + " bytes after its end");
  }
  auto forest = Forest::create(std::move(trees), std::move(command));
  if (!forest) return damaged(forest.error());
  if (layers->empty()) return forest;
  auto correction = Perceptron::create(std::move(*layers));
  if (!correction) return damaged(correction.error());
  auto corrected = forest->corrected_by(std::move(*correction));
  if (!corrected) return damaged(corrected.error());
  return corrected;
}

}  // namespace

std::uint32_t Forest::checksum() const {
  return crc32(payload_of(*this));
}

std::vector<std::byte> Forest::serialize() const {
  const auto payload = payload_of(*this);
  ByteWriter header;
  header.put_text(kMagic);
  header.put(kVersion);
  header.put(crc32(payload));
  header.put(static_cast<std::uint64_t>(payload.size()));
  auto bytes = header.take();
  bytes.insert(bytes.end(), payload.begin(), payload.end());
  return bytes;
}

Expected<Forest> Forest::parse(std::span<const std::byte> bytes, const std::string& name) {
  ByteReader in(bytes);
  if (in.left() < kMagic.size() || std::memcmp(bytes.data(), kMagic.data(), kMagic.size()) != 0) {
    return fail(name + ": not a part forest (it does not begin with ARMFORST); make one with 'armature forest train'");
  }
  if (in.left() < kHeaderBytes) return fail(name + ": truncated model: its header is incomplete");
  (void)in.get_text(kMagic.size());
  if (const auto version = in.get<std::uint32_t>(); version != kVersion) {
    return fail(name + ": model version " + std::to_string(version) + ", this program reads version " +
                std::to_string(kVersion) + "; train it again with 'armature forest train'");
  }
  const auto expected_checksum = in.get<std::uint32_t>();
  const auto payload_size = in.get<std::uint64_t>();
  if (in.left() != payload_size) {
    return fail(name + (in.left() < payload_size ? ": truncated model: " : ": damaged model: ") +
                std::to_string(in.left()) + " bytes after the header, expected " + std::to_string(payload_size));
  }
  if (crc32(bytes.subspan(kHeaderBytes)) != expected_checksum) {
    return fail(name + ": damaged model: its checksum does not match its contents; copy or train it again");
  }
  return parse_payload(in, name);
}

Expected<Forest> Forest::load(const std::filesystem::path& path) {
  const std::string name = path.string();
  std::error_code failed;
  const auto size = std::filesystem::file_size(path, failed);
  if (failed) return fail(name + ": cannot read the model: " + failed.message());
  if (size > kMaxFileBytes) return fail(name + ": " + std::to_string(size) + " bytes, too large for a model");
  std::vector<std::byte> bytes(size);
  std::ifstream file(path, std::ios::binary);
  // std::ifstream reads char; the bytes are the same.
  file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (!file) return fail(name + ": cannot read the model: reading stopped before its end");
  return parse(bytes, name);
}

Expected<void> Forest::save(const std::filesystem::path& path) const {
  const auto bytes = serialize();
  auto temporary = path;
  temporary += ".tmp";
  {
    std::ofstream file(temporary, std::ios::binary | std::ios::trunc);
    file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    file.close();
    if (!file) {
      std::error_code ignored;
      std::filesystem::remove(temporary, ignored);
      return fail(temporary.string() + ": cannot write the model; is the folder there, with room?");
    }
  }
  std::error_code failed;
  std::filesystem::rename(temporary, path, failed);
  if (failed) return fail(path.string() + ": cannot put the model in place: " + failed.message());
  return {};
}

}  // namespace armature
