// Fuzzes the streams of Gaussians that views draw: in memory, in a file, growing, with requested chunks, and with
// damaged chunks that parity restores.
#include "qnv/codecs/gaussians/lod/splat_stream.h"
#include "qnv/codecs/octree/lod/lod_source.h"
#include "qnv/reader/loss.h"
#include "qnv/sampling/volume/volume_values.h"
#include "tests/fuzz/qnv_targets.h"
#include "tests/fuzz/stream_bytes.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

using namespace gs::qnv;

namespace gs::fuzz {

std::vector<std::uint8_t> with_checksums(std::span<const std::byte> bytes) {
  std::vector<std::uint8_t> mended(bytes.size());
  std::transform(bytes.begin(), bytes.end(), mended.begin(),
                 [](std::byte b) { return std::to_integer<std::uint8_t>(b); });
  mend_checksums(mended);
  return mended;
}

void check_sound(const Geometry& geometry) {
  const VectorView vectors(geometry);
  require(vectors.normals.size() == vectors.size() && vectors.weights.size() == vectors.size());
  require(vectors.colors.empty() || vectors.colors.size() == vectors.size());
  require(vectors.classes.empty() || vectors.classes.size() == vectors.size());
  require(vectors.cells.empty() || vectors.cells.size() == vectors.size());
  for (const float weight : vectors.weights) require(weight > 0 && std::isfinite(weight));
  for (const glm::vec3& p : vectors.positions) require(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z));
  if (const auto* splats = geometry.as<Gaussians>()) {
    const std::size_t n = splats->size();
    require(splats->scales.size() == n && splats->rotations.size() == n && splats->opacities.size() == n);
    require(splats->bases.size() == n && splats->harmonics.size() == n * harmonic_count(splats->degree));
    for (const glm::vec4& q : splats->rotations)
      require(std::abs(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w - 1) < 1e-3f);
    for (const glm::vec3& s : splats->scales) require(s.x >= s.y && s.y >= s.z && s.z >= 0 && std::isfinite(s.x));
    for (const glm::vec3& c : splats->bases) require(std::isfinite(c.x + c.y + c.z));
    for (const float opacity : splats->opacities) require(opacity > 0 && opacity <= 1);
  }
  const auto* mesh = geometry.as<IndexedMesh>();
  if (!mesh) return;
  require(mesh->triangles.size() % 3 == 0);
  for (const std::uint32_t vertex : mesh->triangles) require(vertex < mesh->size());
}

namespace {

constexpr std::size_t kMaxCut = 1 << 16;

void check_cut(const std::vector<SplatRun>& runs) {
  std::size_t count = 0;
  for (const SplatRun& run : runs) {
    require(run.splats && run.first <= run.splats->size() && run.count <= run.splats->size() - run.first);
    require(run.presence > 0 && run.presence <= 1);
    const Gaussians& splats = *run.splats;
    const std::size_t per = harmonic_count(splats.degree);
    require(splats.harmonics.size() == per * splats.size());
    for (std::size_t i = run.first; i < std::size_t{run.first} + run.count; ++i) {
      const glm::vec3 &p = splats.positions[i], &s = splats.scales[i], &c = splats.bases[i];
      require(std::isfinite(p.x + p.y + p.z) && std::isfinite(c.x + c.y + c.z));
      require(s.x >= s.y && s.y >= s.z && s.z >= 0 && std::isfinite(s.x));
      require(splats.opacities[i] > 0 && splats.opacities[i] <= 1);
      for (std::size_t k = per * i; k < per * (i + 1); ++k) {
        const glm::vec3& h = splats.harmonics[k];
        require(std::isfinite(h.x + h.y + h.z));
      }
    }
    count += run.count;
  }
  require(count <= 2 * kMaxCut);  // includes Gaussians that fade out
}

/// Draws a stream in near and far views of two viewports, with and without a clock.
void look_at(SplatStream& stream) {
  stream.set_limits({.cache_bytes = std::size_t{1} << 17, .cut_splats = kMaxCut});
  LodView view;
  double time = 0;
  const glm::vec3 middle = stream.box().lower + stream.box().size() * 0.5f;
  for (const float away : {1000.0f, 3.0f, 0.0f, 30.0f}) {
    view.eye = middle + glm::vec3(away);
    view.error_pixels = away < 10 ? 0.0f : 1.0f;
    view.budget = away == 3 ? 300 : 0;
    view.viewport = away == 30 ? 1 : 0;
    view.most_decoded = away == 0 ? 1000 : 0;
    check_cut(stream.cut(view, away == 0 ? std::optional(time) : std::nullopt));
    view.planes[0] = {1, 0, 0, -middle.x};
    check_cut(stream.cut(view, time += 0.1));
    view.planes = {};
    for (const ChunkRange& range : stream.wanted()) require(range.bytes >= kChunkHeaderBytes);
  }
  check_sound(stream.whole().decode(kMaxVectors));
  require(stream.overview(100).size() <= 100 || stream.statistics().clusters > 0);
}

/// Gives a stream the directory, and then the chunks that its views request.
void request(std::span<const std::byte> sound) {
  const auto part = [&](std::uint64_t offset, std::size_t bytes) {
    const std::size_t first = static_cast<std::size_t>(std::min<std::uint64_t>(offset, sound.size()));
    return sound.subspan(first, std::min(bytes, sound.size() - first));
  };
  auto begun = SplatStream::begin(sound.first(std::min<std::size_t>(sound.size(), 600)));
  auto* stream = std::get_if<std::unique_ptr<SplatStream>>(&begun);
  if (!stream) return;
  (void)(*stream)->set_directory(part((*stream)->directory(), sound.size()));
  for (int round = 0; round < 4; ++round) {
    LodView view;
    view.error_pixels = 0;
    check_cut((*stream)->cut(view));
    for (const ChunkRange& range : (*stream)->wanted())
      (void)(*stream)->add(range.offset, part(range.offset, range.bytes));
  }
  look_at(**stream);
}

}  // namespace

bool run_gaussians(std::span<const std::byte> bytes) {
  bool taken = false;
  const auto look = [&](SplatStream::Opened opened) {
    auto* stream = std::get_if<std::unique_ptr<SplatStream>>(&opened);
    if (!stream) return;
    look_at(**stream);
    taken = taken || (*stream)->statistics().clusters > 0;
  };
  const std::vector<std::uint8_t> mended = with_checksums(bytes);
  const std::span<const std::byte> sound = std::as_bytes(std::span(mended));
  look(SplatStream::open(sound));
  look(SplatStream::open(memory_source({sound.begin(), sound.end()})));
  // Damaged chunks keep their wrong checksums, so that parity restores them.
  look(SplatStream::open(memory_source({bytes.begin(), bytes.end()})));
  auto growing = SplatStream::begin(sound.first(std::min<std::size_t>(sound.size(), 600)));
  if (auto* stream = std::get_if<std::unique_ptr<SplatStream>>(&growing)) {
    if (sound.size() > 600)
      in_pieces(sound.subspan(600), [&](std::span<const std::byte> piece) { (void)(*stream)->push(piece); });
    look_at(**stream);
    (*stream)->finish();
    look_at(**stream);
  }
  request(sound);
  const std::uint64_t seed = bytes.empty() ? 0 : std::to_integer<std::uint64_t>(bytes.back());
  look(SplatStream::open(drop_packets(sound, 0.3, seed)));
  return taken;
}

}  // namespace gs::fuzz
