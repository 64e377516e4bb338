#include "app/insitu/arrays/ranks.h"

#include "base/thread_time.h"

#include <algorithm>
#include <chrono>
#include <cstring>

namespace gs::app::insitu {
namespace {

constexpr int kInsituTag = 4711;

}  // namespace

Ranks::Ranks(const gs_insitu_communicator* table) {
  if (!table) return;
  std::memcpy(&table_, table, std::min(table->size, sizeof table_));
  rank_ = table_.rank;
  count_ = table_.ranks;
  if (is_first()) agreed_.resize(static_cast<std::size_t>(count_));
}

// Calls a function of the caller. Measures how long it blocks without using the processor.
template <class Call>
bool Ranks::run(const Call& call) {
  using Clock = std::chrono::steady_clock;
  const double processor = thread_seconds();
  const Clock::time_point begun = Clock::now();
  failed_ = call() != 0 || failed_;
  const double passed = std::chrono::duration<double>(Clock::now() - begun).count();
  blocked_ += std::max(passed - (thread_seconds() - processor), 0.0);
  return !failed_;
}

bool Ranks::broadcast(void* data, std::size_t bytes) {
  if (failed_) return false;
  if (count_ == 1) return true;
  if (is_first()) sent_ += bytes;
  return run([&] { return table_.broadcast(table_.context, data, bytes, 0); });
}

bool Ranks::gather(const void* data, std::size_t bytes, void* all) {
  if (failed_) return false;
  if (count_ == 1) {
    std::memcpy(all, data, bytes);
    return true;
  }
  if (!is_first()) sent_ += bytes;
  return run([&] { return table_.gather(table_.context, data, bytes, all, 0); });
}

bool Ranks::send(const void* data, std::size_t bytes) {
  if (failed_) return false;
  sent_ += bytes;
  return run([&] { return table_.send(table_.context, data, bytes, 0, kInsituTag); });
}

bool Ranks::receive(void* data, std::size_t bytes, int from) {
  if (failed_) return false;
  return run([&] { return table_.receive(table_.context, data, bytes, from, kInsituTag); });
}

bool Ranks::agree(bool own, bool& all) {
  all = own;
  if (count_ == 1) return !failed_;
  std::uint32_t flag = own ? 1 : 0;
  if (!gather(&flag, sizeof flag, agreed_.data())) return false;
  if (is_first()) flag = std::ranges::count(agreed_, 1U) == count_ ? 1 : 0;
  if (!broadcast(flag)) return false;
  all = flag != 0;
  return true;
}

const char* check_communicator(const gs_insitu_communicator& table) {
  if (table.size < sizeof(gs_insitu_communicator)) return "the size of the communicator is wrong; set `size` to sizeof";
  if (table.ranks < 1 || table.rank < 0 || table.rank >= table.ranks)
    return "the communicator has no such rank; expected 0 <= rank < ranks";
  if (table.ranks > 1 && !(table.broadcast && table.gather && table.barrier && table.send && table.receive))
    return "the communicator lacks a function; expected all five";
  return nullptr;
}

}  // namespace gs::app::insitu
