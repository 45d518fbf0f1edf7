#include "tracker/forest/checkpoint.h"

#include <fstream>
#include <iterator>
#include <string_view>
#include <system_error>

#include "tracker/forest/checksum.h"
#include "tracker/forest/tree_codec.h"

namespace armature {
namespace {

constexpr std::string_view kMagic = "ARMTRAIN";

Expected<void> write(const std::filesystem::path& path, std::span<const std::byte> bytes, std::ios::openmode mode) {
  std::ofstream file(path, std::ios::binary | mode);
  file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (!file) return fail(path.string() + ": cannot write the checkpoint; is the folder there, with room?");
  return {};
}

std::vector<std::byte> header(const std::string& settings) {
  ByteWriter out;
  out.put_text(kMagic);
  out.put(static_cast<std::uint32_t>(settings.size()));
  out.put_text(settings);
  return out.take();
}

}  // namespace

Expected<Checkpoint> Checkpoint::create(const std::filesystem::path& path, const std::string& settings) {
  Checkpoint checkpoint;
  checkpoint.path_ = path;
  if (const auto written = write(path, header(settings), std::ios::trunc); !written) {
    return tl::unexpected(written.error());
  }
  return checkpoint;
}

Expected<Checkpoint> Checkpoint::resume(const std::filesystem::path& path, const std::string& settings) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return fail(path.string() + ": no checkpoint to resume from; train without --resume");
  const std::vector<char> chars{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  const auto bytes = std::as_bytes(std::span(chars));
  const auto expected = header(settings);
  if (bytes.size() < expected.size() || !std::equal(expected.begin(), expected.end(), bytes.begin())) {
    return fail(path.string() + ": the checkpoint of a training run with other options; train without --resume");
  }

  Checkpoint checkpoint;
  checkpoint.path_ = path;
  std::size_t good = expected.size();
  while (true) {
    ByteReader in(bytes.subspan(good));
    if (in.left() < 8) break;
    const auto checksum = in.get<std::uint32_t>();
    const auto size = in.get<std::uint32_t>();
    if (in.left() < size || size < 8 || crc32(bytes.subspan(good + 8, size)) != checksum) break;
    SubtreeId id;
    id.tree = in.get<std::uint32_t>();
    id.path = in.get<std::uint32_t>();
    auto tree = get_tree(in);
    if (!tree) break;
    checkpoint.finished_.insert_or_assign(id, std::move(*tree));
    good += 8 + size;
  }
  std::error_code failed;
  std::filesystem::resize_file(path, good, failed);
  if (failed) return fail(path.string() + ": cannot drop the unfinished end: " + failed.message());
  return checkpoint;
}

Expected<void> Checkpoint::append(SubtreeId id, const Tree& tree) {
  ByteWriter body;
  body.put(id.tree);
  body.put(id.path);
  put_tree(body, tree);
  const auto bytes = body.take();
  ByteWriter record;
  record.put(crc32(bytes));
  record.put(static_cast<std::uint32_t>(bytes.size()));
  auto out = record.take();
  out.insert(out.end(), bytes.begin(), bytes.end());
  return write(path_, out, std::ios::app);
}

}  // namespace armature
