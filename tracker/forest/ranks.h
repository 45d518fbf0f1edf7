#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <vector>

namespace armature {

/// The processes that train one forest together, each with its share of the images: image i is with rank i modulo
/// count(). All ranks call the same functions in the same order, each of which returns when all have called it. A rank
/// that cannot go on ends the others too.
/// Thread-safe: no.
class Ranks {
 public:
  Ranks() = default;
  Ranks(const Ranks&) = delete;
  Ranks& operator=(const Ranks&) = delete;
  virtual ~Ranks() = default;

  [[nodiscard]] virtual int rank() const noexcept = 0;
  [[nodiscard]] virtual int count() const noexcept = 0;

  /// Replaces each value by its sum over all ranks.
  virtual void sum(std::span<std::int64_t> values) = 0;
  /// Gives each rank its own stretch of the sums over all ranks: of `values`, the same length on all, the first
  /// lengths[0] are for rank 0, the next lengths[1] for rank 1 and so on. They replace the first of `values`.
  virtual void sum_apart(std::span<std::uint16_t> values, std::span<const std::size_t> lengths) = 0;
  /// Replaces `bytes` by those of rank 0.
  virtual void broadcast(std::vector<std::byte>& bytes) = 0;
  /// Ends all ranks at once, after a failure of this one alone.
  [[noreturn]] virtual void abort() noexcept = 0;
};

/// One process alone: every sum is its own. Thread-safe: yes.
class OneRank : public Ranks {
 public:
  [[nodiscard]] int rank() const noexcept override { return 0; }
  [[nodiscard]] int count() const noexcept override { return 1; }
  void sum(std::span<std::int64_t>) override {}
  void sum_apart(std::span<std::uint16_t>, std::span<const std::size_t>) override {}
  void broadcast(std::vector<std::byte>&) override {}
  [[noreturn]] void abort() noexcept override { std::abort(); }
};

/// Whether any rank says so.
[[nodiscard]] inline bool any_rank(Ranks& ranks, bool mine) {
  std::int64_t count = mine ? 1 : 0;
  ranks.sum({&count, 1});
  return count != 0;
}

}  // namespace armature
