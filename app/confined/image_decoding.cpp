#include "app/confined/image_decoding.h"

#include "app/confined/decoder_pool.h"
#include "render/image/image_codecs.h"

#include <chrono>
#include <memory>
#include <utility>

namespace gs::app {
namespace {

// A damaged file of the greatest size takes less. The limits of a world stop it earlier.
constexpr std::chrono::seconds kPatience{60};

}  // namespace

std::variant<render::Image, render::ImageError> decode_confined(std::span<const std::byte> bytes,
                                                                const render::ImageLimits& limits) {
  DecoderPool& pool = DecoderPool::of_program();
  if (pool.program().empty()) return render::decode_image(bytes, limits);
  const DecoderKind kind = render::is_movie(bytes) ? DecoderKind::movies : DecoderKind::pictures;
  auto process = pool.take(kind);
  auto decoded = process->decode(bytes, limits, kPatience);
  pool.give_back(kind, std::move(process));
  return decoded;
}

}  // namespace gs::app
