#pragma once

#include "qnv/codecs/shared/ranks.h"
#include "qnv/codecs/shared/spill_store.h"
#include "qnv/codecs/shared/stream_sink.h"

#include <algorithm>
#include <barrier>
#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

// Ranks of an encoder as threads of a test.
namespace gs::qnv {

/// Memory that several ranks share: gathered bytes, stores, results of finished work, and the stream.
struct SharedMemory {
  explicit SharedMemory(std::uint32_t count) : gathered(count), stores(count), barrier(count) {}

  std::vector<std::vector<std::byte>> gathered;
  std::vector<MemoryStore> stores;
  std::barrier<> barrier;
  std::mutex mutex;
  std::map<std::string, std::vector<std::byte>, std::less<>> finished;
  std::size_t restored = 0;  // number of restored results
  std::vector<std::byte> stream;
};

class ThreadRanks final : public Ranks {
 public:
  ThreadRanks(SharedMemory& state, std::uint32_t rank) : state_(state), rank_(rank) {}
  std::uint32_t rank() const override { return rank_; }
  std::uint32_t count() const override { return static_cast<std::uint32_t>(state_.gathered.size()); }
  std::vector<std::byte> gather(std::span<const std::byte> own) override {
    state_.gathered[rank_].assign(own.begin(), own.end());
    state_.barrier.arrive_and_wait();
    std::vector<std::byte> all;
    for (const auto& one : state_.gathered) all.insert(all.end(), one.begin(), one.end());
    state_.barrier.arrive_and_wait();
    return all;
  }

 private:
  SharedMemory& state_;
  std::uint32_t rank_;
};

/// Store of one rank, which also reads the stores of other ranks. The high bits of an offset are the rank.
class RankStore final : public SpillStore {
 public:
  RankStore(SharedMemory& state, std::uint32_t rank) : state_(state), rank_(rank) {}
  bool append(std::span<const std::byte> bytes) override {
    const std::lock_guard lock(state_.mutex);
    if (fails_at != 0 && state_.stores[rank_].size() + bytes.size() > fails_at) return false;
    return state_.stores[rank_].append(bytes);
  }
  std::uint64_t size() const override {
    const std::lock_guard lock(state_.mutex);
    return (std::uint64_t{rank_} << kBits) + state_.stores[rank_].size();
  }
  bool read(std::uint64_t offset, std::span<std::byte> to) const override {
    const std::lock_guard lock(state_.mutex);
    const std::uint64_t mask = (std::uint64_t{1} << kBits) - 1;
    return state_.stores[static_cast<std::size_t>(offset >> kBits)].read(offset & mask, to);
  }
  std::optional<std::vector<std::byte>> finished(std::string_view work) const override {
    const std::lock_guard lock(state_.mutex);
    const auto found = state_.finished.find(work);
    if (found == state_.finished.end()) return std::nullopt;
    ++state_.restored;
    return found->second;
  }
  bool finish(std::string_view work, std::uint64_t, std::span<const std::byte> result) override {
    const std::lock_guard lock(state_.mutex);
    state_.finished.emplace(work, std::vector<std::byte>(result.begin(), result.end()));
    return true;
  }
  std::uint64_t fails_at = 0;  // 0 means never

 private:
  static constexpr int kBits = 40;
  SharedMemory& state_;
  std::uint32_t rank_;
};

/// Part of a stream that one rank writes.
class RankSink final : public StreamSink {
 public:
  explicit RankSink(SharedMemory& state) : state_(state) {}
  bool write(std::span<const std::byte> bytes) override {
    put(at_, bytes);
    return skip(bytes.size());
  }
  bool rewrite_front(std::span<const std::byte> bytes) override {
    put(0, bytes);
    return true;
  }
  bool skip(std::uint64_t bytes) override {
    at_ += bytes;
    return true;
  }

 private:
  void put(std::uint64_t at, std::span<const std::byte> bytes) {
    const std::lock_guard lock(state_.mutex);
    if (state_.stream.size() < at + bytes.size()) state_.stream.resize(at + bytes.size());
    std::ranges::copy(bytes, state_.stream.begin() + static_cast<std::ptrdiff_t>(at));
  }
  SharedMemory& state_;
  std::uint64_t at_ = 0;
};

}  // namespace gs::qnv
