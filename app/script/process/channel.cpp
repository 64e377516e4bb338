#include "app/script/process/channel.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <climits>
#include <ctime>
#include <thread>

#include <fcntl.h>
#include <linux/futex.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace gs::app::script {
namespace {

using ChannelClock = std::chrono::steady_clock;
constexpr std::chrono::microseconds kLookFor{50};
constexpr long kSleepNanoseconds = 10'000'000;

void pause_briefly() {
#if defined(__x86_64__)
  __builtin_ia32_pause();
#else
  std::atomic_signal_fence(std::memory_order_seq_cst);
#endif
}

long futex(std::atomic<std::uint32_t>& word, int operation, std::uint32_t value, const timespec* timeout) {
  static_assert(sizeof(word) == sizeof(std::uint32_t) && std::atomic<std::uint32_t>::is_always_lock_free);
  return ::syscall(SYS_futex, &word, operation, value, timeout, nullptr, 0);
}

}  // namespace

Channel::~Channel() {
  if (memory_) (void)::munmap(memory_, sizeof *memory_);
}

bool Channel::map(int file, Side side) {
  void* const at = ::mmap(nullptr, sizeof(ChannelMemory), PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
  if (at == MAP_FAILED) return false;
  memory_ = static_cast<ChannelMemory*>(at);  // a new file has only zeros
  out_ = side == Side::world ? &memory_->to_programs : &memory_->to_world;
  in_ = side == Side::world ? &memory_->to_world : &memory_->to_programs;
  own_processor_ = side == Side::world ? &memory_->world_processor : &memory_->programs_processor;
  other_processor_ = side == Side::world ? &memory_->programs_processor : &memory_->world_processor;
  return true;
}

net::Descriptor Channel::create() {
  net::Descriptor file(::memfd_create("ghostspace-programs", MFD_CLOEXEC | MFD_ALLOW_SEALING));
  if (!file || ::ftruncate(file.get(), sizeof(ChannelMemory)) != 0 ||
      ::fcntl(file.get(), F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW) != 0 || !map(file.get(), Side::world))
    return {};
  return file;
}

bool Channel::open(const net::Descriptor& file) { return map(file.get(), Side::programs); }

// Waits until the box of a lane is full or empty.
bool Channel::wait(Lane& lane, std::uint32_t full) const {
  static const bool looks = std::thread::hardware_concurrency() > 1;
  const std::int32_t processor = ::sched_getcpu() + 1;
  own_processor_->store(processor, std::memory_order_relaxed);
  const auto end = ChannelClock::now() + kLookFor;
  for (int i = 1; looks; ++i) {
    if (lane.full.load(std::memory_order_acquire) == full) return true;
    if (other_processor_->load(std::memory_order_relaxed) == processor) break;
    pause_briefly();
    if (i % 32 == 0 && ChannelClock::now() >= end) break;
  }
  constexpr timespec kSleep{0, kSleepNanoseconds};
  while (lane.full.load(std::memory_order_acquire) != full) {
    lane.waits.store(1);
    const std::uint32_t now = lane.full.load();
    if (now == full) break;
    (void)futex(lane.full, FUTEX_WAIT, now, patience_ ? &kSleep : nullptr);
    if (patience_ && lane.full.load(std::memory_order_acquire) != full && !patience_()) return false;
  }
  return true;
}

void Channel::turn(Lane& lane, std::uint32_t full) {
  lane.full.store(full);
  if (lane.waits.exchange(0) != 0) (void)futex(lane.full, FUTEX_WAKE, INT_MAX, nullptr);
}

bool Channel::send(std::span<const std::byte> message) {
  if (!out_) return false;
  do {
    if (!wait(*out_, 0)) return false;
    const std::size_t part = std::min(message.size(), Lane::kBytes);
    std::ranges::copy(message.first(part), out_->data);
    message = message.subspan(part);
    out_->length = static_cast<std::uint32_t>(part);
    out_->last = message.empty() ? 1 : 0;
    turn(*out_, 1);
  } while (!message.empty());
  return true;
}

bool Channel::receive(std::vector<std::byte>& message, std::size_t most) {
  message.clear();
  if (!in_) return false;
  for (;;) {
    if (!wait(*in_, 1)) return false;
    // The other process may change the numbers at any time, so each is read once.
    const std::uint32_t length = *static_cast<volatile std::uint32_t*>(&in_->length);
    const bool last = *static_cast<volatile std::uint32_t*>(&in_->last) != 0;
    if (length > Lane::kBytes || length > most - message.size()) return false;
    message.insert(message.end(), in_->data, in_->data + length);
    turn(*in_, 0);
    if (last) return true;
  }
}

}  // namespace gs::app::script
