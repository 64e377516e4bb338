#include "app/confined/decoder_pool.h"

namespace gs::app {

DecoderPool& DecoderPool::of_program() {
  static DecoderPool the_pool;
  return the_pool;
}

std::unique_ptr<DecoderProcess> DecoderPool::take(DecoderKind kind) {
  {
    const std::lock_guard lock(mutex_);
    auto& waiting = idle_[static_cast<std::size_t>(kind)];
    while (!waiting.empty()) {
      auto process = std::move(waiting.back());
      waiting.pop_back();
      if (process->runs()) return process;
    }
  }
  return std::make_unique<DecoderProcess>(program_, kind);
}

void DecoderPool::give_back(DecoderKind kind, std::unique_ptr<DecoderProcess> process) {
  if (!process->good()) return;
  const std::lock_guard lock(mutex_);
  auto& waiting = idle_[static_cast<std::size_t>(kind)];
  if (waiting.size() < kMostIdle) waiting.push_back(std::move(process));
}

}  // namespace gs::app
