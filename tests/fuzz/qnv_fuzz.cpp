// Fuzzes decoders of streams. Any bytes must decode without harm, whole and in pieces, to the same valid geometry,
// which must be drawable at any detail. Broken checksums are corrected first, so that the fuzzer reaches the code after
// them.
#include "qnv/codecs/displaced/tessellation/patch_mesh.h"
#include "qnv/codecs/octree/lod/lod.h"
#include "qnv/codecs/outlines/outline_stream.h"
#include "qnv/codecs/values/bricks/brick_volume.h"
#include "qnv/reader/loss.h"
#include "qnv/reader/stream_decoder.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/qnv_targets.h"

#include <algorithm>
#include <cmath>
#include <memory>

using namespace gs::qnv;

namespace gs::fuzz {
namespace {

// Passes all bytes at once to one decoder, and in pieces to another. The results must be equal.
template <class Decoder>
void read(std::span<const std::byte> bytes, Decoder& whole, Decoder& pieces) {
  (void)whole.push(bytes);
  whole.finish();
  in_pieces(bytes, [&](std::span<const std::byte> piece) { (void)pieces.push(piece); });
  pieces.finish();
}

void decode(std::span<const std::byte> bytes) {
  StreamDecoder whole(kMaxVectors), pieces(kMaxVectors);
  read(bytes, whole, pieces);
  const Geometry geometry = whole.geometry(), other_geometry = pieces.geometry();
  const VectorView vectors(geometry), other(other_geometry);
  check_sound(geometry);
  const bool of_values = whole.header() && whole.header()->payload == Payload::values;
  require(vectors.size() <= whole.vectors() && (of_values || vectors.size() == whole.vectors()));
  require(vectors.size() <= kMaxVectors);
  require(std::ranges::equal(vectors.positions, other.positions) && std::ranges::equal(vectors.weights, other.weights));
  require(whole.problems().size() == pieces.problems().size());
}

// Returns the corners of all received polygons, ordered by their kind.
std::vector<glm::vec3> corners_of(OutlineDecoder& decoder, std::size_t& polygons) {
  std::vector<glm::vec3> corners;
  for (const OutlineBatch& batch : decoder.take()) {
    polygons += batch.polygons.size();
    require(batch.groups.size() == batch.polygons.size());
    for (std::size_t i = 0; i < batch.polygons.size(); ++i) {
      const OutlinePolygon polygon = batch.polygons[i];
      for (std::size_t ring = 0; ring < polygon.rings(); ++ring) require(polygon.ring(ring).size() >= 3);
      for (const std::uint32_t corner : bridged_ring(polygon)) require(corner < polygon.positions.size());
    }
    for (const glm::vec3& p : batch.polygons.positions) {
      require(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z));
      corners.push_back(p);
    }
  }
  return corners;
}

void decode_outlines(std::span<const std::byte> bytes) {
  OutlineDecoder whole(kMaxVectors), pieces(kMaxVectors);
  read(bytes, whole, pieces);
  std::size_t polygons = 0, others = 0;
  require(corners_of(whole, polygons) == corners_of(pieces, others) && polygons == others);
  require(polygons == whole.outline_polygons() + whole.inner_polygons());
}

bool run_stream(std::span<const std::byte> bytes) {
  decode(bytes);
  decode_outlines(bytes);
  const std::vector<std::uint8_t> mended = with_checksums(bytes);
  if (!std::equal(bytes.begin(), bytes.end(), std::as_bytes(std::span(mended)).begin())) {
    decode(std::as_bytes(std::span(mended)));
    decode_outlines(std::as_bytes(std::span(mended)));
  }
  StreamDecoder decoder(kMaxVectors);
  (void)decoder.push(bytes);
  return decoder.header() != nullptr;
}

/// Draws a stream with levels in near and far views, and then completely.
void look_at(LodStream& stream) {
  LodView view;
  view.budget = 1 << 12;
  for (const float away : {0.0f, 3.0f, 1000.0f}) {
    view.eye = {away, away, away};
    view.error_pixels = away + 1;
    for (const Piece& piece : stream.cut(view)) {
      require(piece.splats && piece.first <= piece.splats->size() && piece.count <= piece.splats->size() - piece.first);
      check_sound(*piece.splats);
    }
    (void)stream.wanted();
  }
  if (stream.count() <= kMaxVectors) check_sound(stream.whole());
}

/// Fuzzes streams with levels, for which views select chunks: complete in memory, growing, and with only some of the
/// chunks.
bool run_levels(std::span<const std::byte> bytes) {
  constexpr std::size_t kCache = std::size_t{1} << 20;
  const std::vector<std::uint8_t> mended = with_checksums(bytes);
  const std::span<const std::byte> sound = std::as_bytes(std::span(mended));
  bool taken = false;
  auto opened = LodStream::open(std::vector(sound.begin(), sound.end()), kCache);
  if (auto* stream = std::get_if<std::unique_ptr<LodStream>>(&opened)) {
    look_at(**stream);
    taken = (*stream)->statistics().clusters > 0;
  }
  auto lying = LodStream::open(memory_source(std::vector(sound.begin(), sound.end())), kCache);
  if (auto* stream = std::get_if<std::unique_ptr<LodStream>>(&lying)) look_at(**stream);
  auto growing = LodStream::begin(sound.first(std::min<std::size_t>(sound.size(), 300)), kCache);
  if (auto* stream = std::get_if<std::unique_ptr<LodStream>>(&growing)) {
    if (sound.size() > 300)
      in_pieces(sound.subspan(300), [&](std::span<const std::byte> piece) { (void)(*stream)->push(piece); });
    (*stream)->finish();
    look_at(**stream);
  }
  const std::uint64_t seed = bytes.empty() ? 0 : std::to_integer<std::uint64_t>(bytes.back());
  const std::vector<std::byte> lossy = drop_packets(sound, 0.3, seed);
  StreamDecoder decoder(kMaxVectors);
  (void)decoder.push(lossy);
  decoder.finish();
  check_sound(decoder.geometry());
  return taken;
}

/// Draws patches in near and far views.
void look_at(const SurfacePatches& patches) {
  PatchMesh mesh;
  LodView view;
  view.budget = 1 << 12;
  for (const float away : {0.0f, 3.0f, 1000.0f}) {
    view.eye = {away, away, away};
    view.error_pixels = away + 1;
    const SurfaceCut cut = cut_surface(patches, view);
    const std::size_t stride = 1 + cut.patches.size() / 32;  // test only some of the patches
    for (std::size_t i = 0; i < cut.patches.size(); i += stride) {
      const PatchCut& one = cut.patches[i];
      require(one.part < patches.parts.size() && one.patch < patches.parts[one.part]->size());
      mesh.build(*patches.parts[one.part], one);
      for (const PatchVertex& vertex : mesh.vertices())
        require(std::isfinite(vertex.position.x) && std::isfinite(vertex.position.y) &&
                std::isfinite(vertex.position.z));
      for (const auto& some : {mesh.inner(), mesh.border()})
        for (const PatchMesh::Triangle& t : some)
          for (const auto corner : t) require(corner < mesh.vertices().size());
    }
  }
}

/// Fuzzes a stream that is drawn while it is received: first the prefix, then all of it.
bool run_drawn(std::span<const std::byte> bytes) {
  const std::vector<std::uint8_t> mended = with_checksums(bytes);
  const std::span<const std::byte> sound = std::as_bytes(std::span(mended));
  StreamDecoder decoder(kMaxVectors);
  bool patches = false;
  const auto look = [&] {
    const Geometry geometry = decoder.geometry_to_draw();
    const auto* surface = geometry.as<SurfacePatches>();
    if (!surface) return check_sound(geometry);
    patches = true;
    look_at(*surface);
  };
  (void)decoder.push(sound.first(sound.size() / 2));
  look();
  (void)decoder.push(sound.subspan(sound.size() / 2));
  decoder.finish();
  look();
  return patches;
}

/// Draws a volume in bricks in near and far views.
bool look_at(BrickVolume& bricks) {
  LodView view;
  view.pixels = 1e4f;
  bool pending = false, any = false;
  for (const float away : {0.0f, 30.0f, 1000.0f}) {
    view.eye = {away, away / 2, away};
    view.volume.exact = away < 100;
    view.volume.slices[1] = glm::vec4(0, 1, 0, -away);
    const auto volume = bricks.cut(view, pending);
    check_sound(Volume(*volume));
    for (const ValueBrick& brick : volume->values ? volume->values->bricks : std::vector<ValueBrick>()) {
      require(brick.samples->size() == std::size_t{brick.size[0]} * brick.size[1] * brick.size[2]);
      const auto& [x, y, z] = brick.core_first;
      if (brick.error_of(x, y, z)) require(brick.level == 0);
    }
    for (const ChunkRange& range : bricks.wanted()) require(range.bytes >= kChunkHeaderBytes);
    any = any || bricks.statistics().shown > 0;
  }
  return any;
}

/// Fuzzes volumes in bricks: in a file, and growing with some of the chunks.
bool run_bricks(std::span<const std::byte> bytes) {
  BrickLimits limits;
  limits.brick_bytes = std::size_t{4} << 20;
  limits.arrived_bytes = std::size_t{8} << 10;
  limits.base_vectors = 512;
  const std::vector<std::uint8_t> mended = with_checksums(bytes);
  const std::span<const std::byte> sound = std::as_bytes(std::span(mended));
  bool taken = false;
  auto opened = BrickVolume::open(memory_source(std::vector(sound.begin(), sound.end())), limits);
  if (const auto* bricks = std::get_if<std::shared_ptr<BrickVolume>>(&opened)) taken = look_at(**bricks);
  auto begun = BrickVolume::begin(sound.first(sound.size() / 2), limits);
  const auto* bricks = std::get_if<std::shared_ptr<BrickVolume>>(&begun);
  if (!bricks) return taken;
  const std::uint64_t directory = (*bricks)->directory();
  if (directory < sound.size()) (void)(*bricks)->set_directory(sound.subspan(static_cast<std::size_t>(directory)));
  (void)look_at(**bricks);
  for (const ChunkRange& range : (*bricks)->wanted())
    if (range.offset < sound.size() && range.bytes <= sound.size() - range.offset)
      (void)(*bricks)->add(
          range.offset, sound.subspan(static_cast<std::size_t>(range.offset), static_cast<std::size_t>(range.bytes)));
  (void)look_at(**bricks);
  return taken;
}

}  // namespace

std::vector<FuzzTarget> fuzz_targets() {
  return {{"streams", run_stream, 16384},
          {"levels", run_levels, 16384},
          {"drawn", run_drawn, 16384},
          {"bricks", run_bricks, 16384},
          {"gaussians", run_gaussians, 24576}};
}

}  // namespace gs::fuzz
