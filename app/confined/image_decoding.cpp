#include "app/confined/image_decoding.h"

#include "app/confined/decoder_process.h"
#include "render/image/image_codecs.h"

#include <array>
#include <chrono>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace gs::app {
namespace {

// A damaged file of the greatest size takes less. The limits of a world stop it earlier.
constexpr std::chrono::seconds kPatience{60};
constexpr std::size_t kMostIdle = 2;  // of each kind

/// Children that wait for work.
struct Pool {
  std::mutex mutex;
  std::string program;
  std::array<std::vector<std::unique_ptr<DecoderProcess>>, 2> idle;

  [[nodiscard]] std::unique_ptr<DecoderProcess> take(DecoderKind kind) {
    {
      const std::lock_guard lock(mutex);
      auto& waiting = idle[static_cast<std::size_t>(kind)];
      while (!waiting.empty()) {
        auto process = std::move(waiting.back());
        waiting.pop_back();
        if (process->runs()) return process;
      }
    }
    return std::make_unique<DecoderProcess>(program, kind);
  }
  void give_back(DecoderKind kind, std::unique_ptr<DecoderProcess> process) {
    if (!process->good()) return;
    const std::lock_guard lock(mutex);
    auto& waiting = idle[static_cast<std::size_t>(kind)];
    if (waiting.size() < kMostIdle) waiting.push_back(std::move(process));
  }
};
Pool& pool() {
  static Pool the_pool;
  return the_pool;
}

}  // namespace

void set_decoder_program(std::string program) { pool().program = std::move(program); }

std::variant<render::Image, render::ImageError> decode_confined(std::span<const std::byte> bytes,
                                                                const render::ImageLimits& limits) {
  if (pool().program.empty()) return render::decode_image(bytes, limits);
  const DecoderKind kind = render::is_movie(bytes) ? DecoderKind::movies : DecoderKind::pictures;
  auto process = pool().take(kind);
  auto decoded = process->decode(bytes, limits, kPatience);
  pool().give_back(kind, std::move(process));
  return decoded;
}

}  // namespace gs::app
