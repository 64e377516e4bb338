#pragma once

#include "app/encode/encode_team.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace gs::app {

/// Rank of MPI_COMM_WORLD. Counts its messages.
class MpiRanks final : public qnv::Ranks {
 public:
  /// MPI must be initialised.
  MpiRanks();
  [[nodiscard]] std::uint32_t rank() const override { return rank_; }
  [[nodiscard]] std::uint32_t count() const override { return count_; }
  [[nodiscard]] std::vector<std::byte> gather(std::span<const std::byte> own) override;

  [[nodiscard]] std::uint64_t messages() const { return messages_; }
  [[nodiscard]] std::uint64_t sent_bytes() const { return sent_; }
  [[nodiscard]] std::uint64_t largest_message() const { return largest_; }

 private:
  std::uint32_t rank_ = 0, count_ = 1;
  std::uint64_t messages_ = 0, sent_ = 0, largest_ = 0;  // of this rank
};

/// Processes that mpirun started. Ranks other than 0 discard their output, and keep their errors hidden.
class MpiTeam final : public EncodeTeam {
 public:
  /// Initialises MPI. `arguments` without --resume identify the task.
  MpiTeam(int* count, char*** arguments);
  /// Finalises MPI. Without end_together(), aborts the other processes, because they may wait for this one.
  ~MpiTeam() override;
  MpiTeam(const MpiTeam&) = delete;
  MpiTeam& operator=(const MpiTeam&) = delete;

  [[nodiscard]] qnv::Ranks& ranks() override { return ranks_; }
  [[nodiscard]] unsigned threads() const override { return threads_; }
  [[nodiscard]] std::string task() const override { return task_; }
  [[nodiscard]] std::string hidden_errors() const override;
  [[nodiscard]] std::unique_ptr<TeamFile> create(const std::string& path) override;
  [[nodiscard]] JsonValue statistics() override;
  void end_together() override;

 private:
  void hide_output();

  /// Calls MPI_Init before the ranks exist.
  struct Start {
    Start(int* count, char*** arguments);
  };
  Start start_;
  MpiRanks ranks_;
  unsigned threads_ = 1;
  std::string task_;
  int errors_ = -1;  // file with hidden errors
  int shown_ = -1;   // standard error of mpirun
  bool together_ = false;
  std::uint64_t written_ = 0;  // by this rank into the stream
};

}  // namespace gs::app
