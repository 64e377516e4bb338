#include "qnv/codecs/gaussians/lod/splat_stream.h"

#include "qnv/codecs/shared/decoder.h"

#include <algorithm>
#include <memory>

namespace gs::qnv {
namespace {

// Viewport number of overview(); no window uses it.
constexpr std::uint32_t kOverviewViewport = 0xfffffffe;
// Pixels of one unit of length for overview(): the budget alone limits the detail.
constexpr float kClose = 1e12f;

}  // namespace

std::size_t bytes_of_splat(int degree) {
  return 3 * sizeof(glm::vec3) + sizeof(glm::vec4) + sizeof(float) + harmonic_count(degree) * sizeof(glm::vec3);
}

Gaussians WholeSplats::decode(std::size_t most) const {
  const auto decoder = make_gaussians_decoder(header_, most);
  std::vector<std::byte> buffer;
  bool damaged = false;
  for (const auto& place : chunks_) {
    const auto chunk = read_chunk(*source_, place.offset, place.bytes, buffer);
    const auto* sound = std::get_if<SoundChunk>(&chunk);
    if (sound && is_harmonics(sound->type) == is_harmonics(place.type))
      decoder->add(sound->type, sound->payload, {});
    else
      damaged = true;
  }
  if (damaged && header_.parity)
    (void)gaussians::read_whole(*source_, true,
                                [&](ChunkType type, std::span<const std::byte> payload, std::uint64_t offset) {
                                  if (offset >= gaussians::kNowhere) decoder->add(type, payload, {});
                                });
  Geometry all = decoder->geometry({header_.description, header_.color});
  return std::move(*all.as<Gaussians>());
}

SplatStream::Opened SplatStream::make(gaussians::SplatChunks::Opened opened) {
  if (auto* problem = std::get_if<StreamProblem>(&opened)) return std::move(*problem);
  return std::unique_ptr<SplatStream>(new SplatStream(std::move(std::get<gaussians::SplatChunks>(opened))));
}

SplatStream::Opened SplatStream::open(std::span<const std::byte> bytes) {
  Opened opened = begin(bytes);
  if (auto* stream = std::get_if<std::unique_ptr<SplatStream>>(&opened)) {
    (*stream)->finish();
    if ((*stream)->chunks_.tree().root() == gaussians::kNoCluster) return StreamProblem{0, "has no root cluster"};
  }
  return opened;
}

SplatStream::Opened SplatStream::open(std::shared_ptr<const ChunkSource> source) {
  return make(gaussians::SplatChunks::open(std::move(source), true));
}

SplatStream::Opened SplatStream::begin(std::span<const std::byte> front) {
  return make(gaussians::SplatChunks::begin(front));
}

void SplatStream::set_limits(const SplatLimits& limits) {
  const std::size_t most = limits.cut_bytes / bytes_of_splat(header().gaussians.degree);
  cutter_.set_most_splats(std::clamp<std::size_t>(most, 1, limits.cut_splats));
  cache_.set_most_bytes(limits.cache_bytes);
  chunks_.set_most_bytes(limits.arrived_bytes);
}

Gaussians SplatStream::overview(std::size_t most) {
  LodView view;
  view.eye = box().lower + box().size() * 0.5f;
  view.pixels = kClose;
  view.error_pixels = 0;
  view.budget = most;
  view.viewport = kOverviewViewport;
  Gaussians all{GeometryBase{header().description, header().color}};
  all.antialiased = header().gaussians.antialiased;
  for (const SplatRun& run : cut(view)) {
    const auto copy = [&](const auto& from, auto& to) {
      const auto first = from.begin() + static_cast<std::ptrdiff_t>(run.first);
      to.insert(to.end(), first, first + static_cast<std::ptrdiff_t>(run.count));
    };
    copy(run.splats->positions, all.positions);
    copy(run.splats->scales, all.scales);
    copy(run.splats->rotations, all.rotations);
    copy(run.splats->opacities, all.opacities);
    copy(run.splats->bases, all.bases);
  }
  forget(kOverviewViewport);
  return all;
}

}  // namespace gs::qnv
