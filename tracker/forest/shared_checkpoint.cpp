#include "tracker/forest/shared_checkpoint.h"

#include <utility>

#include "tracker/forest/tree_codec.h"

namespace armature {

Expected<SharedCheckpoint> SharedCheckpoint::open(const std::filesystem::path& path, bool resume,
                                                  const std::string& settings, Ranks& ranks) {
  SharedCheckpoint shared(ranks);
  if (!path.empty() && ranks.rank() == 0) {
    auto opened = resume ? Checkpoint::resume(path, settings) : Checkpoint::create(path, settings);
    if (opened) {
      shared.file_ = std::move(*opened);
    } else {
      shared.status_ = tl::unexpected(opened.error());
    }
  }
  if (const auto status = shared.status(); !status) return tl::unexpected(status.error());
  return shared;
}

Expected<void> SharedCheckpoint::status() const {
  ByteWriter out;
  if (!status_) out.put_text(status_.error().message);
  auto message = out.take();
  ranks_->broadcast(message);
  if (message.empty()) return {};
  ByteReader in(message);
  return fail(in.get_text(in.left()));
}

std::optional<Tree> SharedCheckpoint::finished(SubtreeId id) const {
  ByteWriter out;
  if (file_ && file_->finished().contains(id)) put_tree(out, file_->finished().at(id));
  auto bytes = out.take();
  ranks_->broadcast(bytes);
  if (bytes.empty()) return {};
  ByteReader in(bytes);
  return get_tree(in);
}

void SharedCheckpoint::append(SubtreeId id, const Tree& tree) {
  if (file_ && status_) status_ = file_->append(id, tree);
}

}  // namespace armature
