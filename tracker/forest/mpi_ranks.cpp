// Ranks that mpirun started. A plug-in, so that `armature` itself runs where no MPI is installed.

#include <exception>
#include <limits>

#include <mpi.h>

#include "tracker/forest/ranks.h"

namespace {

/// Whatever fails in MPI ends all ranks with MPI's own message: its default.
class MpiRanks : public armature::Ranks {
 public:
  MpiRanks() {
    int provided = 0;  // only the main thread talks to MPI
    MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
    MPI_Comm_size(MPI_COMM_WORLD, &count_);
  }
  ~MpiRanks() override { MPI_Finalize(); }

  [[nodiscard]] int rank() const noexcept override { return rank_; }
  [[nodiscard]] int count() const noexcept override { return count_; }

  void sum(std::span<std::int64_t> values) override {
    MPI_Allreduce(MPI_IN_PLACE, values.data(), length(values.size()), MPI_INT64_T, MPI_SUM, MPI_COMM_WORLD);
  }
  void sum_apart(std::span<std::uint16_t> values, std::span<const std::size_t> lengths) override {
    std::vector<int> counts;
    for (const std::size_t count : lengths) counts.push_back(length(count));
    MPI_Reduce_scatter(MPI_IN_PLACE, values.data(), counts.data(), MPI_UINT16_T, MPI_SUM, MPI_COMM_WORLD);
  }
  void broadcast(std::vector<std::byte>& bytes) override {
    std::uint64_t size = bytes.size();
    MPI_Bcast(&size, 1, MPI_UINT64_T, 0, MPI_COMM_WORLD);
    bytes.resize(size);
    MPI_Bcast(bytes.data(), length(size), MPI_BYTE, 0, MPI_COMM_WORLD);
  }
  [[noreturn]] void abort() noexcept override {
    MPI_Abort(MPI_COMM_WORLD, 1);
    std::terminate();
  }

 private:
  /// Messages are far shorter: the histograms of one batch of nodes, or one subtree.
  static int length(std::size_t count) {
    if (count > static_cast<std::size_t>(std::numeric_limits<int>::max())) std::terminate();
    return static_cast<int>(count);
  }
  int rank_ = 0;
  int count_ = 1;
};

}  // namespace

extern "C" armature::Ranks* armature_join_mpi_ranks() {
  return new MpiRanks;
}
