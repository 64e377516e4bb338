#pragma once

#include "base/noncopyable.h"
#include "net/base/descriptor.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace gs::app::script {

/// Box for one part of a message in one direction, in memory that two processes share. The sender fills it, the
/// receiver empties it.
struct Lane {
  static constexpr std::size_t kBytes = std::size_t{1} << 18;

  std::atomic<std::uint32_t> full;   // 1 while the box holds a part
  std::atomic<std::uint32_t> waits;  // 1 if a process sleeps until `full` changes
  std::uint32_t length, last;        // bytes of the part; 1 for the last part of a message
  std::byte data[kBytes];
};

struct ChannelMemory {
  Lane to_programs, to_world;
  std::atomic<std::int32_t> world_processor, programs_processor;  // 1 + number of the processor on which each side ran
  std::atomic<std::uint32_t> progress;  // number of the orders of the last message that the programs have begun
};

/// End of a channel between a world and the process of its programs. To wait, it polls for some microseconds, unless
/// the other process needs its processor, then sleeps. Trusts nothing that the other process writes. One thread.
class Channel : NonCopyable {
 public:
  enum class Side : std::uint8_t { world, programs };

  Channel() = default;
  ~Channel();
  /// Creates the shared memory, with a size that cannot change. Returns its descriptor; none on failure.
  [[nodiscard]] net::Descriptor create();
  /// Maps the shared memory of another process.
  [[nodiscard]] bool open(const net::Descriptor& file);

  /// Sets the function that is called about every 10 ms while this end waits. If it returns false, the wait fails.
  void set_patience(std::function<bool()> patience) { patience_ = std::move(patience); }
  /// Tells the other end the number of the last message's orders that were begun.
  void set_progress(std::uint32_t begun) { memory_->progress.store(begun, std::memory_order_relaxed); }
  /// Returns the number that the other end told; 0 without memory. The other end may be hostile.
  [[nodiscard]] std::uint32_t progress() const {
    return memory_ ? memory_->progress.load(std::memory_order_relaxed) : 0;
  }
  /// Sends a message. Returns false if the wait for the other process failed.
  [[nodiscard]] bool send(std::span<const std::byte> message);
  /// Receives a message of at most `most` bytes. Returns false if the wait failed, or if the message is longer.
  [[nodiscard]] bool receive(std::vector<std::byte>& message, std::size_t most);

 private:
  bool map(int file, Side side);
  bool wait(Lane& lane, std::uint32_t full) const;
  static void turn(Lane& lane, std::uint32_t full);

  ChannelMemory* memory_ = nullptr;
  Lane *out_ = nullptr, *in_ = nullptr;
  std::atomic<std::int32_t>*own_processor_ = nullptr, *other_processor_ = nullptr;
  std::function<bool()> patience_;
};

}  // namespace gs::app::script
