#pragma once

#include <condition_variable>
#include <cstdlib>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "tracker/forest/ranks.h"

namespace armature {

/// Ranks that are threads of one process, for tests.
class ThreadRanks {
 public:
  explicit ThreadRanks(int count) : count_(count), values_(static_cast<std::size_t>(count)) {}

  /// Calls work(ranks) on every rank; returns when all are done.
  void run(const std::function<void(Ranks&)>& work) {
    std::vector<std::jthread> threads;
    for (int rank = 0; rank < count_; ++rank) {
      threads.emplace_back([this, rank, &work] {
        Member member(*this, rank);
        work(member);
      });
    }
  }

 private:
  class Member : public Ranks {
   public:
    Member(ThreadRanks& all, int rank) : all_(all), rank_(rank) {}
    [[nodiscard]] int rank() const noexcept override { return rank_; }
    [[nodiscard]] int count() const noexcept override { return all_.count_; }
    void sum(std::span<std::int64_t> values) override {
      const auto sums = sums_of(values);
      std::ranges::copy(sums, values.begin());
    }
    void sum_apart(std::span<std::uint16_t> values, std::span<const std::size_t> lengths) override {
      const auto sums = sums_of(std::vector<std::int64_t>(values.begin(), values.end()));
      std::size_t begin = 0;
      for (int rank = 0; rank < rank_; ++rank) begin += lengths[static_cast<std::size_t>(rank)];
      for (std::size_t i = 0; i < lengths[static_cast<std::size_t>(rank_)]; ++i) {
        values[i] = static_cast<std::uint16_t>(sums[begin + i]);
      }
    }
    void broadcast(std::vector<std::byte>& bytes) override {
      if (rank_ == 0) all_.bytes_ = bytes;
      all_.wait_for_all();
      bytes = all_.bytes_;
      all_.wait_for_all();
    }
    [[noreturn]] void abort() noexcept override { std::abort(); }

   private:
    template <class Values>
    std::vector<std::int64_t> sums_of(const Values& values) {
      all_.values_[static_cast<std::size_t>(rank_)].assign(values.begin(), values.end());
      all_.wait_for_all();
      std::vector<std::int64_t> sums(values.size(), 0);
      for (const auto& of_rank : all_.values_) {
        for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += of_rank.at(i);
      }
      all_.wait_for_all();
      return sums;
    }
    ThreadRanks& all_;
    int rank_;
  };

  /// Unlike std::barrier it sleeps at once: there may be more ranks than cores.
  void wait_for_all() {
    std::unique_lock lock(mutex_);
    const int round = round_;
    if (++came_ == count_) {
      came_ = 0;
      ++round_;
      all_came_.notify_all();
    } else {
      all_came_.wait(lock, [&] { return round_ != round; });
    }
  }

  int count_;
  std::mutex mutex_;
  std::condition_variable all_came_;
  int came_ = 0;
  int round_ = 0;
  std::vector<std::vector<std::int64_t>> values_;
  std::vector<std::byte> bytes_;
};

}  // namespace armature
