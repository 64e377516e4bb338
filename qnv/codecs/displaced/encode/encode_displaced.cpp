#include "qnv/codecs/displaced/encode/encode_displaced.h"

#include "base/parallel.h"
#include "qnv/codecs/displaced/decode/surface_stages.h"
#include "qnv/codecs/displaced/encode/stage_encode.h"
#include "qnv/codecs/displaced/encode/thin_surface.h"
#include "qnv/codecs/lossless/encode/surface_tail.h"
#include "qnv/codecs/lossless/encode/tail_cover.h"
#include "qnv/codecs/progressive/encode/progressive_stream.h"
#include "qnv/codecs/shared/encode_options.h"
#include "qnv/codecs/shared/shared_records.h"
#include "qnv/codecs/shared/stream_writer.h"
#include "qnv/codecs/shared/surface_header.h"
#include "qnv/container/piece_group.h"
#include "qnv/mesh/simplify/simplify.h"
#include "qnv/mesh/survey.h"
#include "qnv/mesh/triangle_pipeline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <optional>
#include <span>
#include <string>
#include <utility>

namespace gs::qnv {
namespace {

using displaced::EncodedStage;
using displaced::StageCluster;

constexpr std::size_t kFirstTriangles = 640;
// Limits for a surface that a displaced stage suits: bytes of the base mesh, and error of the stage relative to the
// box. Other surfaces are better encoded as an octree.
constexpr std::size_t kMaxFirstBytes = 4000;
constexpr float kMaxFirstError = 0.002f;
// Components with less than this fraction of the area are excluded from the stages. They form an extra stage at the
// end.
constexpr double kMinPart = 2e-4;
// Maximum error of a stage, in edges of the source. Above it, another stage with four times as many triangles follows.
constexpr float kMaxError = 0.045f;
constexpr std::size_t kMaxStages = 4;
// Bytes of clusters that a stage sends if another stage follows, relative to that stage's base mesh.
constexpr double kBeforeNext = 1.5;
// Parity bytes relative to the bytes that they protect: for the front of the last stage, and for the small components.
// kParityBesides pieces are added. At 30 % loss, one stage in a hundred is lost.
constexpr double kParity = 0.75, kParityBeside = 0.4;
constexpr std::size_t kParityBesides = 3, kMaxFrontBytes = 100'000;
constexpr std::size_t kClustersAt = 3;  // byte offset of `clusters` in an encoded StageHeader
// Base meshes are simplified from a mesh with this number of triangles, which is precise enough.
constexpr std::size_t kCoarseTriangles = 30'000;
// Maximum quantisation step of the finest layer, relative to an edge of the source.
constexpr float kFinestStep = 1.0f / 14;

// Maximum bytes before the exact tail, relative to the tail. The second value applies if the user requested the tail:
// the total should then stay small. Otherwise intermediate pictures matter more.
constexpr double kBeforeTail = 1.0 / 9, kBeforeChosenTail = 1.0 / 6;
// Maximum bytes before the tail of a textured surface, relative to the tail, because the texture adds to the tail; and
// the minimum in bytes.
constexpr double kBeforeTexturedTail = 1.0 / 3, kMinBeforeTextured = 2000;
// Weight of the stage that is drawn until the tail is complete, as a fraction of the tail's bytes.
constexpr double kWorthOfTail = 0.5, kWorthOfChosenTail = 1;
// Minimum bytes of a stage after its front, relative to the front, if a tail follows. With fewer bytes, the stage looks
// no better than the previous one.
constexpr double kBesidesFront = 0.5;
// Maximum fraction of the bytes before the tail that bases of later stages may use. A base without further clusters
// does not pay.
constexpr double kBasesBeforeTail = 0.5;
// Limits of surfaces that get an exact tail instead of an octree, if a displaced stage does not suit: maximum triangles
// and maximum bytes of the tail.
constexpr std::size_t kFewTriangles = 100'000, kMaxSmallTail = 100'000;

/// Sorts clusters for sending: largest gain per byte first. A cluster never precedes the clusters that it refines.
std::vector<StageCluster> ordered(std::vector<StageCluster> clusters, std::size_t patches) {
  using Kind = displaced::ClusterHeader::Kind;
  // Sort by dependency: by level within a layer, layer by layer; colours separately.
  std::stable_sort(clusters.begin(), clusters.end(), [](const StageCluster& a, const StageCluster& b) {
    const auto rank = [](const StageCluster& c) {
      return std::array{static_cast<int>(c.header.kind), c.header.layer, c.header.level};
    };
    return rank(a) < rank(b);
  });
  constexpr double kAny = 1e300;
  // For each patch, the minimum gain per byte of its earlier clusters.
  std::array<std::vector<double>, displaced::kLayers + 1> so_far;
  for (auto& worth : so_far) worth.assign(patches, kAny);
  std::vector<std::pair<double, std::size_t>> keys;
  for (std::size_t i = 0; i < clusters.size(); ++i) {
    const auto& h = clusters[i].header;
    auto& worth = so_far[h.kind == Kind::color ? displaced::kLayers : static_cast<std::size_t>(h.layer)];
    double key = clusters[i].gain / static_cast<double>(clusters[i].payload.size() + 10);
    for (std::uint32_t p = h.first; p < h.first + h.count; ++p) key = std::min(key, worth[p]);
    for (std::uint32_t p = h.first; p < h.first + h.count; ++p) worth[p] = key;
    keys.emplace_back(key, i);
  }
  std::stable_sort(keys.begin(), keys.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<StageCluster> out;
  out.reserve(clusters.size());
  for (const auto& [key, i] : keys) out.push_back(std::move(clusters[i]));
  return out;
}

OutgoingChunk chunk_of(StageCluster cluster, const displaced::Frame& frame) {
  OutgoingChunk chunk;
  chunk.type = ChunkType::displaced;
  chunk.entry.level = static_cast<std::uint8_t>(cluster.header.level);
  chunk.entry.parent = 0xffffffff;
  chunk.entry.vectors = cluster.vertices;
  chunk.entry.box = {frame.outside(cluster.box.lower), frame.outside(cluster.box.upper)};
  chunk.payload = std::move(cluster.payload);
  return chunk;
}

/// Front of a later stage: its base mesh, and the clusters that a decoder requires before it draws the stage.
class StageFront {
 public:
  StageFront(const EncodedStage& stage, int number, std::size_t clusters, const Box& box) {
    displaced::ClusterHeader head;
    head.kind = displaced::ClusterHeader::Kind::base;
    head.stage = number;
    std::vector<std::vector<std::byte>> payloads{displaced::encode_cluster_header(head)};
    payloads[0].insert(payloads[0].end(), stage.bytes.begin(), stage.bytes.end());
    entry_.parent = 0xffffffff;
    entry_.vectors = static_cast<std::uint32_t>(stage.header.base.vertices.size());
    entry_.box = box;
    for (std::size_t i = 0; i < clusters; ++i) {
      payloads.push_back(stage.clusters[i].payload);
      entry_.vectors += stage.clusters[i].vertices;
    }
    pieces_ = stage.header.beside ? cut_group(number, payloads, kParityBeside, kParityBesides)
                                  : cut_group(number, payloads, kParity, kParityBesides);
  }
  void append(bool parity, std::vector<OutgoingChunk>& chunks) {
    for (std::vector<std::byte>& piece : parity ? pieces_.parity : pieces_.data) {
      OutgoingChunk& chunk = chunks.emplace_back();
      chunk.type = ChunkType::piece;
      chunk.entry = entry_;
      if (parity || &piece != &pieces_.data.back()) chunk.entry.vectors = 0;
      chunk.payload = std::move(piece);
    }
  }

 private:
  CutGroup pieces_;
  DirectoryEntry entry_;
};

/// Chunks of all stages in order. A stage with a successor sends only the clusters that pay until the successor is
/// drawn. `places` is the number of source vertices. `distances` has the squared error of the drawn surface before the
/// first chunk and after each chunk, in the unit of cluster gains.
struct StageChunks {
  std::vector<OutgoingChunk> chunks;
  std::vector<double> distances;
  std::vector<std::vector<OutgoingChunk>> parity;  // parity of the front of each stage
  std::vector<std::size_t> begins, ready;          // per stage: its first chunk, and the first after its front
};
StageChunks chunks_of(std::vector<EncodedStage> stages, const Box& box, std::size_t places) {
  const displaced::Frame frame(box);
  StageChunks out;
  std::vector<OutgoingChunk>& chunks = out.chunks;
  std::vector<double>& distances = out.distances;
  out.parity.resize(stages.size());
  double shown = 0;  // error of the previous stage, in the unit of gains
  for (std::size_t i = 0; i < stages.size(); ++i) {
    EncodedStage& stage = stages[i];
    double left = static_cast<double>(stage.error) * stage.error * static_cast<double>(places);
    for (const StageCluster& cluster : stage.clusters) left += cluster.gain;
    if (i == 0) distances = {left};
    std::size_t needed = 0, bytes = 0, sent = 0;
    out.begins.push_back(chunks.size());
    if (i > 0) {
      const std::size_t most = std::min<std::size_t>(stage.clusters.size(), 255);
      double then = left;
      while (!stage.header.beside && needed < most && then > shown) then -= stage.clusters[needed++].gain;
      for (std::size_t k = needed; k < most; ++k)
        if (stage.clusters[k].header.layer == 0 && stage.clusters[k].header.level == 1) needed = k + 1;
      stage.bytes[kClustersAt] = static_cast<std::byte>(stage.header.beside ? 0 : needed);
      std::size_t grouped = stage.bytes.size();
      while (sent < needed && grouped + stage.clusters[sent].payload.size() < kMaxFrontBytes) {
        grouped += stage.clusters[sent].payload.size();
        left -= stage.clusters[sent++].gain;
      }
      StageFront front(stage, static_cast<int>(i), sent, box);
      front.append(false, chunks);
      distances.resize(chunks.size(), shown);
      distances.push_back(left);
      front.append(true, out.parity[i]);
      bytes = grouped - stage.bytes.size();
    }
    out.ready.push_back(chunks.size());
    const double most = i + 1 < stages.size() ? static_cast<double>(stages[i + 1].bytes.size()) * kBeforeNext : 1e300;
    for (; sent < stage.clusters.size(); ++sent) {
      StageCluster& cluster = stage.clusters[sent];
      if (static_cast<double>(bytes) > most) break;
      bytes += cluster.payload.size();
      left -= cluster.gain;
      chunks.push_back(chunk_of(std::move(cluster), frame));
      distances.push_back(left);
    }
    shown = left;
  }
  return out;
}

/// Truncates `chunks` to those that fit into `bytes`, including container overhead, and that pay before a tail of
/// `tail` bytes. Minimises the sum of the drawn error over all bytes until the tail is complete.
void keep_before(StageChunks& stages, double bytes, double tail) {
  std::vector<OutgoingChunk>& chunks = stages.chunks;
  std::size_t kept = 0, stage = 0;
  double least = stages.distances[0] * tail, shown = 0, sum = 0, began = 0, front = 0;
  for (std::size_t i = 0; i < chunks.size(); ++i) {
    const auto more = static_cast<double>(kChunkHeaderBytes + kDirectoryEntryBytes + chunks[i].payload.size());
    if (stage + 1 < stages.begins.size() && i == stages.begins[stage + 1]) {
      ++stage;
      began = sum;
    }
    sum += more;
    if (sum > bytes) break;
    shown += stages.distances[i] * more;
    if (i + 1 <= stages.ready[stage]) front = sum - began;
    const bool enough = stage == 0 || sum - began >= (1 + kBesidesFront) * front;
    if (const double all = shown + stages.distances[i + 1] * tail; enough && all <= least) {
      least = all;
      kept = i + 1;
    }
  }
  chunks.resize(kept);
}

/// Returns the stages of a decoder that has received all chunks.
SurfaceStages received_stages(const StreamHeader& header, std::span<const OutgoingChunk> chunks) {
  constexpr std::size_t kMaxDecodedVectors = std::size_t{1} << 26;
  SurfaceStages stages;
  stages.begin(header.base, header.description.box, kMaxDecodedVectors);
  PieceGroups groups;
  for (const OutgoingChunk& chunk : chunks)
    if (chunk.type == ChunkType::piece)
      (void)groups.add(chunk.payload, [&](ChunkType, std::span<const std::byte> payload) { stages.add(payload); });
    else
      stages.add(chunk.payload);
  return stages;
}

std::variant<EncodedStream, EncodeError> encode_with_ranks(EncodeRanks& shared, const TriangleSource& source,
                                                           const EncodeOptions& options, Progress* progress);

/// Thins a surface that exceeds the memory limit, and encodes the result. Collective.
std::variant<EncodedStream, EncodeError> encode_thinned(EncodeRanks& shared, const TriangleSource& source,
                                                        const SurfaceSurvey& survey, const EncodeOptions& options,
                                                        Progress* progress) {
  if (options.exact_bits > 0)
    return EncodeError{"the exact mesh has more than " + std::to_string(options.most_triangles) +
                       " triangles, which exceed the memory limit; expected a smaller mesh, or a larger --memory"};
  auto thinned = thin_surface(shared, source, survey, options.most_triangles, progress);
  if (auto* error = std::get_if<EncodeError>(&thinned)) return std::move(*error);
  EncodeOptions rest = options;
  rest.most_triangles = 0;
  rest.exact_bits = 0;
  auto encoded = encode_with_ranks(shared, std::get<ThinnedSurface>(thinned).source(), rest, progress);
  if (auto* stream = std::get_if<EncodedStream>(&encoded)) stream->thinned = true;
  return encoded;
}

/// Encodes a surface. Only rank 0 returns the stream; other ranks may return while rank 0 still encodes.
std::variant<EncodedStream, EncodeError> encode_with_ranks(EncodeRanks& shared, const TriangleSource& source,
                                                           const EncodeOptions& options, Progress* progress) {
  if (progress) progress->stage = "reading";
  SurfaceSurvey s;
  // A source in runs probably exceeds memory, so its triangles are counted before any is stored.
  const bool surveyed = source.runs() > 1;
  if (surveyed) {
    auto survey = survey_of(shared, source, progress);
    if (auto* failed = std::get_if<EncodeError>(&survey)) return std::move(*failed);
    s = std::get<SurfaceSurvey>(survey);
    if (options.most_triangles != 0 && s.triangles > options.most_triangles)
      return encode_thinned(shared, source, s, options, progress);
  }
  displaced::MeshBuilder builder(true);
  bool too_many = false;
  TrianglePipeline joined([&](std::span<const Triangle> triangles) { builder.add(triangles); }, options.threads);
  const bool read = source([&](std::span<const Triangle> triangles) {
    if (!surveyed) s.add(triangles);
    too_many = options.most_triangles != 0 && s.triangles > options.most_triangles;
    return !too_many && joined.put(triangles) && !is_cancelled(progress);
  });
  joined.finish();
  if (too_many) {
    builder = displaced::MeshBuilder(true);  // releases the builder's memory
    auto survey = survey_of(shared, source, progress);
    if (auto* failed = std::get_if<EncodeError>(&survey)) return std::move(*failed);
    return encode_thinned(shared, source, std::get<SurfaceSurvey>(survey), options, progress);
  }
  std::optional<EncodeError> problem;
  if (!read) problem = EncodeError{is_cancelled(progress) ? "cancelled" : kUnreadable};
  if (auto failed = shared.agree(problem)) return std::move(*failed);
  if (!s.sound()) return EncodeError{"no surface to encode; expected triangles with an area"};
  if (progress) progress->stage = "joining";
  const displaced::Frame frame(s.box);
  const bool chosen = options.exact_bits == kExactWherePays;
  std::optional<exact::ExactMesh> exact;
  const TexturedSurface* textured = options.textured;
  const std::size_t triangles = textured ? textured->triangles.size() : s.triangles;
  if (options.exact_bits > 0 || (chosen && triangles <= kMaxChosenTriangles)) {
    const int bits = std::max(options.exact_bits, 0);
    exact = textured ? exact_mesh_of(*textured, frame, bits) : exact_mesh_of(builder, frame, s.colored, bits);
  }
  // For surfaces with sharp edges and few triangles, the exact mesh is smaller than any good approximation.
  std::optional<exact::ExactMesh> small;
  if (options.only_if_suited && options.exact_bits <= 0 && triangles <= kFewTriangles)
    small = textured ? exact_mesh_of(*textured, frame, kProgressiveBits)
                     : exact_mesh_of(builder, frame, s.colored, kProgressiveBits);
  displaced::Neighbours neighbours;
  displaced::SurfaceMesh mesh = builder.finish(&neighbours);
  if (mesh.triangles.empty()) return EncodeError{"no surface to encode; expected triangles with an area"};
  for (glm::vec3& p : mesh.positions) p = frame.inside(p);
  if (progress) progress->stage = "simplifying";
  // While one thread finishes the simplification, the others build search trees of the target.
  std::optional<displaced::Target> made;
  const displaced::SplitMesh parts = displaced::split_components(mesh, kMinPart);
  const displaced::SurfaceMesh& body = parts.large.triangles.empty() ? parts.small : parts.large;
  const displaced::SimplifyRanks together{shared.rank(), shared.count(),
                                          [&](std::span<const std::byte> own) { return shared.ranks().gather(own); }};
  const displaced::SurfaceMesh coarse = displaced::simplify(
      body, std::min(kCoarseTriangles, body.triangles.size()), options.threads,
      [&] { made.emplace(mesh, std::exchange(neighbours, {}), options.threads); }, together);
  if (shared.rank() != 0) return EncodedStream{};
  const displaced::Target& target = *made;
  if (is_cancelled(progress)) return EncodeError{"cancelled"};
  StreamHeader header = surface_header(Payload::displaced, s, options);
  displaced::BaseMeshPrefetcher prefetcher(coarse, options.threads);
  displaced::StageOptions stage_options;
  stage_options.bases = &prefetcher;
  stage_options.colored = s.colored;
  stage_options.threads = options.threads;
  stage_options.triangles = kFirstTriangles;
  stage_options.most_bytes = room_for_base(header);
  const float wanted = kFinestStep * target.edge();
  float step = std::ldexp(1.0f, -stage_options.step_exponent);
  for (stage_options.layers = 1; stage_options.layers < displaced::kLayers && step > wanted; ++stage_options.layers)
    step = std::ldexp(step, -displaced::kLayerShift);
  int tail_bits = kTailBits;
  std::size_t tail_size = 0;  // approximate, including low bits
  const auto room = [&] {
    if (!exact) return 1e300;
    const double bytes = static_cast<double>(tail_size);
    if (textured && chosen) return std::max(kBeforeTexturedTail * bytes, kMinBeforeTextured);
    return (chosen ? kBeforeChosenTail : kBeforeTail) * bytes;
  };
  std::size_t bases = 0;
  if (progress) progress->stage = "displacing";
  std::vector<EncodedStage> stages;
  do {
    stage_options.number = static_cast<int>(stages.size());
    stage_options.most_error = stages.size() + 1 < kMaxStages ? kMaxError * target.edge() : 0;
    stage_options.trusted_error = stages.empty() && options.only_if_suited ? kMaxFirstError : 1;
    EncodedStage stage = displaced::encode_stage_of(target, coarse, stage_options, progress);
    if (is_cancelled(progress)) return EncodeError{"cancelled"};
    const bool follows = stage.bytes.size() <= kMaxFirstBytes && stage.error <= kMaxFirstError;
    if (stages.empty() && options.only_if_suited && !follows) {
      bool fits = false;
      if (small) {
        if (s.colored && !textured) {
          // Splits the surface where parts of different colours touch, so that colour borders stay sharp.
          displaced::MeshBuilder parted(true, true);
          const bool again = source([&](std::span<const Triangle> some) {
            parted.add(some);
            return !is_cancelled(progress);
          });
          if (!again) return EncodeError{is_cancelled(progress) ? "cancelled" : "the surface cannot be read again"};
          small = exact_mesh_of(parted, frame, true, kProgressiveBits);
        }
        if (!textured)
          if (auto splits = encode_splits(*small, header, options.max_bytes)) return std::move(*splits);
        const std::size_t bytes = rough_tail_size(*small, small->bits);
        fits = bytes <= kMaxSmallTail && stage.bytes.size() <= kMaxFirstBytes &&
               (options.max_bytes == 0 || bytes * 5 / 4 + kMaxFirstBytes <= options.max_bytes);
        exact = std::move(small);
      }
      if (!fits)
        return EncodeError{"the surface has too many or too sharp parts for a base mesh; expected a smooth surface",
                           true};
    }
    if (stages.empty() && exact) {
      tail_bits = options.exact_bits > 0 ? fewest_tail_bits(*exact) : first_tail_bits(*exact);
      tail_size = rough_tail_size(*exact, tail_bits);
      if (tail_size > exact::kMaxTailBytes)
        return EncodeError{"the mesh has " + std::to_string(tail_size) + " bytes; expected at most " +
                           std::to_string(exact::kMaxTailBytes)};
      if (chosen && options.max_bytes != 0 && tail_size > options.max_bytes) exact.reset();
    }
    if (stages.empty() && stage.bytes.size() > kMaxHeaderBytes / 2)
      return EncodeError{"the base mesh has " + std::to_string(stage.bytes.size()) + " bytes; expected at most " +
                         std::to_string(kMaxHeaderBytes / 2)};
    bases += stage.bytes.size();
    if (!stages.empty() && static_cast<double>(bases) > kBasesBeforeTail * room()) break;
    stage.clusters = ordered(std::move(stage.clusters), stage.header.base.triangles.size());
    stages.push_back(std::move(stage));
    stage_options.triangles = displaced::kMoreTriangles * stages.back().header.base.triangles.size();
    stage_options.most_bytes = 0;
  } while (stages.back().error > kMaxError * target.edge() && stage_options.triangles < coarse.triangles.size() &&
           stages.size() < kMaxStages);
  // Add small components unchanged.
  if (!exact && !parts.large.triangles.empty() && !parts.small.triangles.empty()) {
    stage_options.number = static_cast<int>(stages.size());
    stage_options.triangles = parts.small.triangles.size();
    stage_options.most_bytes = 0;
    stage_options.beside = true;
    stage_options.most_error = 0;
    stages.push_back(displaced::encode_stage_of(target, parts.small, stage_options, progress));
    if (is_cancelled(progress)) return EncodeError{"cancelled"};
    if (stages.back().bytes.size() + 8 > kMaxGroupBytes)
      return EncodeError{"the surface has small parts of " + std::to_string(stages.back().bytes.size()) +
                             " bytes; expected at most " + std::to_string(kMaxGroupBytes),
                         true};
  }
  header.base = stages[0].bytes;
  int last = static_cast<int>(stages.size()) - (stages.back().header.beside ? 2 : 1);  // last stage without `beside`
  StageChunks sent = chunks_of(std::move(stages), s.box, target.mesh().positions.size());
  std::vector<OutgoingChunk>& chunks = sent.chunks;
  if (exact)
    keep_before(sent, room() - static_cast<double>(encode_header(header).size()),
                (chosen ? kWorthOfChosenTail : kWorthOfTail) * static_cast<double>(tail_size));
  if (exact) {
    if (progress) progress->stage = "joining";
    // Stages that are drawn until the tail is received.
    const SurfaceStages received = received_stages(header, chunks);
    const SurfaceStages::Shown main = received.main();
    last = main.number;
    const TailCover beside(*exact, *main.surface, main.level, options.threads);
    // For a small stream, use the order of growth with the fewest bytes.
    std::optional<exact::TailRanks> ranks;
    if (options.exact_bits <= 0) ranks = beside.ranks();
    exact::TailOrder order;
    SurfaceTail tail = tail_of(*exact, tail_bits, ranks ? &*ranks : nullptr, &order);
    tail.cover = beside.cover(main.number, order);
    tail.parity = options.exact_bits <= 0;
    if (!exact->coordinates.empty()) set_picture(tail, *textured);
    append_tail(tail, s.box, chunks);
  }
  // Without its front, a whole stage is lost. The loss matters little if another stage follows.
  if (options.exact_bits <= 0)
    for (std::size_t i = 0; i < sent.parity.size(); ++i)
      if (static_cast<int>(i) == last || (!exact && static_cast<int>(i) > last))
        std::ranges::move(sent.parity[i], std::back_inserter(chunks));
  return write_stream(std::move(header), std::move(chunks), options.max_bytes, equal_protection(options));
}

}  // namespace

std::variant<EncodedStream, EncodeError> encode_displaced(const TriangleSource& source, const EncodeOptions& options,
                                                          Progress* progress) {
  EncodeRanks shared(options);
  return result_of_first(shared, encode_with_ranks(shared, source, options, progress));
}

}  // namespace gs::qnv
