#include <algorithm>
#include <iterator>

#include <armature/sdk/selection/selection.h>

namespace armature::sdk {
namespace {

std::vector<FaceId> in_one_only(std::span<const FaceId> a, std::span<const FaceId> b) {
  std::vector<FaceId> result;
  std::ranges::set_symmetric_difference(a, b, std::back_inserter(result));
  return result;
}

}  // namespace

std::vector<FaceId> in_order(std::vector<FaceId> faces) {
  std::ranges::sort(faces);
  faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
  return faces;
}

std::size_t count_pieces(const Adjacency& adjacency, std::span<const FaceId> faces) {
  if (faces.empty()) return 0;
  std::vector<bool> left(faces.back().index() + 1);
  for (const FaceId face : faces) left[face.index()] = true;
  const auto take = [&](FaceId face) {
    if (face.index() >= left.size() || !left[face.index()]) return false;
    left[face.index()] = false;
    return true;
  };
  std::size_t pieces = 0;
  std::vector<FaceId> reached;
  for (const FaceId first : faces) {
    if (!take(first)) continue;
    ++pieces;
    reached.assign(1, first);
    while (!reached.empty()) {
      const FaceId face = reached.back();
      reached.pop_back();
      for (const EdgeId edge : adjacency.edges(face))
        if (edge.valid())
          for (const FaceId next : adjacency.faces(edge))
            if (take(next)) reached.push_back(next);
    }
  }
  return pieces;
}

bool Selection::contains(FaceId face) const noexcept {
  return std::ranges::binary_search(faces_, face);
}

void Selection::combine(std::vector<FaceId> faces, Combine how) {
  faces = in_order(std::move(faces));
  std::vector<FaceId> changed;
  switch (how) {
    case Combine::Replace: changed = in_one_only(faces_, faces); break;
    case Combine::Add: std::ranges::set_difference(faces, faces_, std::back_inserter(changed)); break;
    case Combine::Subtract: std::ranges::set_intersection(faces, faces_, std::back_inserter(changed)); break;
    case Combine::Intersect: std::ranges::set_difference(faces_, faces, std::back_inserter(changed)); break;
  }
  changes_.resize(taken_);
  toggle(changed);
  changes_.push_back(std::move(changed));
  ++taken_;
}

bool Selection::undo() {
  if (taken_ == 0) return false;
  toggle(changes_[--taken_]);
  return true;
}

bool Selection::redo() {
  if (taken_ == changes_.size()) return false;
  toggle(changes_[taken_++]);
  return true;
}

void Selection::toggle(std::span<const FaceId> changed) {
  faces_ = in_one_only(faces_, changed);
}

}  // namespace armature::sdk
