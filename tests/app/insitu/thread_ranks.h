#pragma once

#include "app/insitu/include/ghostspace/insitu.h"
#include "base/noncopyable.h"

#include <condition_variable>
#include <cstddef>
#include <cstring>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace gs::app::insitu::test {

/// Ranks as threads of this process. Copies messages.
class ThreadRanks : NonCopyable {
 public:
  /// Calls `work` on one thread per rank, and waits for all.
  static void run(int count, const std::function<void(int rank, const gs_insitu_communicator& table)>& work) {
    ThreadRanks all(count);
    std::vector<std::thread> threads;
    for (int rank = 0; rank < count; ++rank)
      threads.emplace_back([&, rank] { work(rank, all.contexts_[static_cast<std::size_t>(rank)].table); });
    for (std::thread& thread : threads) thread.join();
  }

 private:
  struct Context {
    ThreadRanks* all = nullptr;
    gs_insitu_communicator table{};
  };
  using Message = std::vector<std::byte>;

  explicit ThreadRanks(int count) : contexts_(static_cast<std::size_t>(count)) {
    for (int rank = 0; rank < count; ++rank) {
      Context& own = contexts_[static_cast<std::size_t>(rank)];
      own.all = this;
      own.table = {sizeof own.table, rank, count, &own, broadcast, gather, barrier, send, receive};
    }
  }

  void put(int from, int to, const void* data, std::size_t bytes) {
    const auto* begin = static_cast<const std::byte*>(data);
    const std::lock_guard lock(mutex_);
    messages_[{from, to}].emplace_back(begin, begin + bytes);
    news_.notify_all();
  }
  int take(int from, int to, void* data, std::size_t bytes) {
    std::unique_lock lock(mutex_);
    auto& queue = messages_[{from, to}];
    news_.wait(lock, [&] { return !queue.empty(); });
    const Message message = std::move(queue.front());
    queue.pop_front();
    if (message.size() != bytes) return 1;
    if (bytes > 0) std::memcpy(data, message.data(), bytes);
    return 0;
  }

  static int broadcast(void* context, void* data, std::size_t bytes, int root) {
    auto& own = *static_cast<Context*>(context);
    if (own.table.rank != root) return own.all->take(root, own.table.rank, data, bytes);
    for (int to = 0; to < own.table.ranks; ++to)
      if (to != root) own.all->put(root, to, data, bytes);
    return 0;
  }
  static int gather(void* context, const void* data, std::size_t bytes, void* all, int root) {
    auto& own = *static_cast<Context*>(context);
    own.all->put(own.table.rank, root, data, bytes);
    for (int from = 0; own.table.rank == root && from < own.table.ranks; ++from)
      if (own.all->take(from, root, static_cast<std::byte*>(all) + static_cast<std::size_t>(from) * bytes, bytes) != 0)
        return 1;
    return 0;
  }
  static int barrier(void*) { return 0; }
  static int send(void* context, const void* data, std::size_t bytes, int to, int) {
    auto& own = *static_cast<Context*>(context);
    own.all->put(own.table.rank, to, data, bytes);
    return 0;
  }
  static int receive(void* context, void* data, std::size_t bytes, int from, int) {
    auto& own = *static_cast<Context*>(context);
    return own.all->take(from, own.table.rank, data, bytes);
  }

  std::mutex mutex_;
  std::condition_variable news_;
  std::map<std::pair<int, int>, std::deque<Message>> messages_;
  std::vector<Context> contexts_;
};

}  // namespace gs::app::insitu::test
