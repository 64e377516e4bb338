#include "qnv/codecs/outlines/outline_stream.h"

#include "qnv/codecs/outlines/encode/outline_pool.h"
#include "qnv/codecs/shared/stream_writer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

namespace gs::qnv::outline {
namespace {

/// Number of polygons of one appearance that form chunks together. The rest at the end forms a chunk of any size.
constexpr std::size_t kInOneRun = 8192;
constexpr std::size_t kMaxGroups = std::size_t{1} << 31;

std::optional<std::string> problem_of(const OutlinePolygons& polygons) {
  const auto ascend = [](std::span<const std::uint32_t> ends, std::size_t last) {
    return std::is_sorted(ends.begin(), ends.end()) && (ends.empty() ? 0 : ends.back()) == last;
  };
  if (!ascend(polygons.ring_ends, polygons.positions.size()))
    return "ring ends that do not ascend to the number of positions";
  if (!ascend(polygons.polygon_ends, polygons.ring_ends.size()))
    return "polygon ends that do not ascend to the number of rings";
  if (polygons.areas.size() != polygons.size()) return "a number of areas that differs from its polygons";
  if (!polygons.texture_coordinates.empty() && polygons.texture_coordinates.size() != polygons.positions.size())
    return "a number of texture coordinates that differs from its positions";
  return std::nullopt;
}

std::optional<EncodeError> problem_of(const OutlineGroups& groups, std::size_t appearances) {
  if (appearances > kMaxOutlineAppearances)
    return EncodeError{std::to_string(appearances) + " appearances; expected at most 65535"};
  if (groups.groups.size() >= kMaxGroups)
    return EncodeError{std::to_string(groups.groups.size()) + " groups; expected fewer than 2^31"};
  for (std::size_t i = 0; i < groups.groups.size(); ++i) {
    const OutlineGroup& group = groups.groups[i];
    if (group.appearance >= appearances)
      return EncodeError{"group " + std::to_string(i) + " names appearance " + std::to_string(group.appearance) +
                         "; expected less than " + std::to_string(appearances)};
    for (const OutlinePolygons* polygons : {&group.outline, &group.inner})
      if (auto problem = problem_of(*polygons)) return EncodeError{"group " + std::to_string(i) + " has " + *problem};
  }
  return std::nullopt;
}

/// Polygons of one appearance that become chunks of one kind.
struct Run {
  ChunkKind kind;
  std::vector<std::uint32_t> polygons;  // indices in the pool of polygons, ascending
};

struct Finished {
  Chunk chunk;
  std::uint32_t first = 0;  // index of its first polygon in the pool
  std::uint32_t staying = 0;
  Box box;
};

/// Encoder of either the outlines or the inner polygons.
class Pass {
 public:
  Pass(const OutlineGroups& groups, const OutlineHeader& header, bool inner, std::size_t chunk_bytes)
      : groups_(groups), header_(header), bits_(header), inner_(inner), chunk_bytes_(chunk_bytes) {}

  PolygonPool pool;
  std::vector<std::uint32_t> counts;  // for outlines: number of inner polygons per group
  bool too_long = false;

  /// Encodes the chunks in order. Returns false if cancelled, or if a polygon does not fit into a chunk. In the second
  /// case, sets `too_long`.
  bool encode(unsigned threads, Progress* progress, std::vector<Finished>& finished) {
    const std::vector<Run> runs = make_runs();
    std::vector<std::vector<Finished>> of_runs(runs.size());
    if (!parallel_for(
            runs.size(), [&](std::size_t i) { of_runs[i] = encode_run(runs[i]); }, threads, progress))
      return false;
    for (std::size_t i = 0; i < runs.size(); ++i) {
      too_long = too_long || of_runs[i].empty();
      for (Finished& chunk : of_runs[i]) finished.push_back(std::move(chunk));
    }
    std::sort(finished.begin(), finished.end(), [](const Finished& a, const Finished& b) { return a.first < b.first; });
    return !too_long;
  }

 private:
  std::vector<Run> make_runs() const {
    std::vector<Run> runs;
    std::vector<std::size_t> open(header_.appearances.size(), std::numeric_limits<std::size_t>::max());
    for (std::size_t i = 0; i < pool.polygons.size(); ++i) {
      const std::uint32_t appearance = groups_.groups[pool.polygons[i].group].appearance;
      std::size_t& run = open[appearance];
      if (run >= runs.size() || runs[run].polygons.size() >= kInOneRun) {
        run = runs.size();
        runs.push_back(
            {{static_cast<std::uint16_t>(appearance), inner_, header_.appearances[appearance].textured}, {}});
      }
      runs[run].polygons.push_back(static_cast<std::uint32_t>(i));
    }
    return runs;
  }

  /// Encodes the polygons of a run as chunks. Returns an empty list if a polygon does not fit into a chunk.
  std::vector<Finished> encode_run(const Run& run) const {
    std::vector<Polygon> polygons;
    polygons.reserve(run.polygons.size());
    for (const std::uint32_t i : run.polygons) {
      Polygon& polygon = polygons.emplace_back(pool.view(i));
      polygon.textured = polygon.textured && run.kind.textured;
      if (!inner_) polygon.count = counts[polygon.group];
    }
    std::vector<Finished> finished;
    std::size_t guess = 64;
    for (std::size_t first = 0; first < polygons.size();) {
      Chunk chunk = fill(std::span<const Polygon>(polygons).subspan(first), run.kind, guess);
      if (chunk.head.lengths.empty() || size(chunk) > kMaxChunkBytes) return {};
      guess = chunk.head.lengths.size();
      const auto in_it = std::span<const Polygon>(polygons).subspan(first, guess);
      finished.push_back(finish(std::move(chunk), in_it, run.polygons[first]));
      first += guess;
    }
    return finished;
  }

  [[nodiscard]] std::size_t size(const Chunk& chunk) const {
    return chunk.head.encode(bits_).size() + chunk.records.size();
  }

  /// Returns a chunk with the first polygons. Includes at least one, and as many as fit well. `guess` is the expected
  /// number.
  Chunk fill(std::span<const Polygon> polygons, const ChunkKind& kind, std::size_t guess) const {
    constexpr int kTries = 6;
    Chunk best;
    std::size_t count = std::min(guess, polygons.size()), too_many = polygons.size() + 1;
    for (int i = 0; i < kTries || best.head.lengths.empty(); ++i) {
      Chunk chunk = encode_chunk_of(polygons.first(count), kind);
      const std::size_t bytes = chunk.head.lengths.empty() ? 4 * chunk_bytes_ : size(chunk);
      const double next = static_cast<double>(count) * static_cast<double>(chunk_bytes_) / static_cast<double>(bytes);
      if (bytes <= chunk_bytes_ || count == 1) {
        if (count > best.head.lengths.size()) best = std::move(chunk);
        if (count + 1 >= too_many || bytes > chunk_bytes_ - chunk_bytes_ / 16) break;
        count = std::clamp(static_cast<std::size_t>(next * 0.99), best.head.lengths.size() + 1, too_many - 1);
      } else {
        too_many = count;
        const std::size_t least = best.head.lengths.size() + 1;
        if (least >= too_many) break;
        count = std::clamp(static_cast<std::size_t>(next * 0.98), std::min(least, too_many - 1), too_many - 1);
      }
    }
    return best;
  }

  Finished finish(Chunk chunk, std::span<const Polygon> polygons, std::uint32_t first) const {
    Finished finished;
    finished.first = first;
    for (const Polygon& polygon : polygons) {
      finished.staying += polygon.count == 0 ? 1 : 0;
      for (const Corner& corner : polygon.corners)
        finished.box.add({header_.positions.at(0, corner.p[0]), header_.positions.at(1, corner.p[1]),
                          header_.positions.at(2, corner.p[2])});
    }
    finished.chunk = std::move(chunk);
    return finished;
  }

  const OutlineGroups& groups_;
  const OutlineHeader& header_;
  LatticeBits bits_;
  bool inner_;
  std::size_t chunk_bytes_;
};

/// Appends chunks, and continues their numbering.
void append_chunks(std::vector<Finished> finished, bool inner, const LatticeBits& bits,
                   std::vector<OutgoingChunk>& chunks) {
  for (Finished& f : finished) {
    OutgoingChunk& out = chunks.emplace_back();
    f.chunk.head.number = static_cast<std::uint32_t>(chunks.size() - 1);
    out.type = inner ? ChunkType::inner : ChunkType::outlines;
    out.payload = f.chunk.payload(bits);
    out.entry.level = inner ? 1 : 0;
    out.entry.parent = std::numeric_limits<std::uint32_t>::max();
    out.entry.vectors = static_cast<std::uint32_t>(f.chunk.head.lengths.size());
    out.entry.box = f.box;
    out.replaced = inner ? 0 : out.entry.vectors - f.staying;
    f.chunk = {};
  }
}

StreamHeader header_of(const OutlineGroups& groups, std::span<const OutlineAppearance> appearances,
                       const Lattices& lattices, const OutlineEncodeOptions& options) {
  StreamHeader header;
  header.payload = Payload::outlines;
  Description& d = header.description;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<glm::length_t>(axis);
    d.box.lower[i] = lattices.positions.at(axis, 0);
    d.box.upper[i] = lattices.positions.at(axis, lattices.positions.size[axis]);
  }
  for (const OutlineGroup& group : groups.groups) {
    if (std::isfinite(group.area)) d.total += group.area;
    if (!appearances[group.appearance].solid) d.two_sided = true;
  }
  if (!std::isfinite(d.total)) d.total = 0;
  d.metadata = options.metadata;
  header.cube = Cube::around(d.box);
  header.outlines.positions = lattices.positions;
  header.outlines.texture_coordinates = lattices.texture_coordinates;
  header.outlines.groups = static_cast<std::uint32_t>(groups.groups.size());
  header.outlines.appearances.assign(appearances.begin(), appearances.end());
  return header;
}

/// Returns an error if the encoded header is too long or cannot be decoded.
std::optional<EncodeError> problem_of(const StreamHeader& header) {
  const std::vector<std::byte> bytes = encode_header(header);
  if (bytes.size() > kMaxHeaderBytes)
    return EncodeError{"the header with its appearances has " + std::to_string(bytes.size()) +
                       " bytes; expected at most " + std::to_string(kMaxHeaderBytes)};
  std::size_t size = 0;
  bool need_more = false;
  const auto read = decode_header(bytes, size, need_more);
  if (const auto* problem = std::get_if<StreamProblem>(&read))
    return EncodeError{"the model does not fit a header: " + problem->message};
  return std::nullopt;
}

}  // namespace
}  // namespace gs::qnv::outline

namespace gs::qnv {

std::variant<EncodedStream, EncodeError> encode_outlines(const OutlineGroups& groups,
                                                         std::span<const OutlineAppearance> appearances,
                                                         const OutlineEncodeOptions& options, Progress* progress) {
  const OutlineAppearance plain;
  if (appearances.empty()) appearances = {&plain, 1};
  if (auto problem = outline::problem_of(groups, appearances.size())) return std::move(*problem);
  const auto lattices = outline::choose_lattices(groups, std::clamp(options.position_bits, 1, kMaxLatticeBits),
                                                 std::clamp(options.texture_bits, 1, 20));
  if (!lattices) return EncodeError{"no finite polygon close enough to the origin for the size of the model"};
  StreamHeader header = outline::header_of(groups, appearances, *lattices, options);
  const outline::LatticeBits bits(header.outlines);
  const std::size_t chunk_bytes = std::clamp<std::size_t>(options.chunk_bytes, 100, 60000);

  std::vector<std::uint32_t> order(groups.groups.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return groups.groups[a].area > groups.groups[b].area; });
  outline::Pass outlines(groups, header.outlines, false, chunk_bytes),
      inner(groups, header.outlines, true, chunk_bytes);
  const std::size_t most = outline::most_corners(bits);
  if (!outline::place_polygons(groups, order, true, *lattices, most, inner.pool) ||
      !outline::place_polygons(groups, order, false, *lattices, most, outlines.pool))
    return EncodeError{"a polygon of more than " + std::to_string(most) +
                       " corners cannot be triangulated, because its rings cross"};
  if (inner.pool.polygons.empty() && outlines.pool.polygons.empty())
    return EncodeError{"no polygon has an area at this precision"};
  outlines.counts.resize(groups.groups.size());
  for (const outline::Placed& polygon : inner.pool.polygons) ++outlines.counts[polygon.group];
  header.outlines.outline_polygons = static_cast<std::uint32_t>(outlines.pool.polygons.size());
  header.outlines.inner_polygons = static_cast<std::uint32_t>(inner.pool.polygons.size());
  if (auto problem = outline::problem_of(header)) return std::move(*problem);

  if (progress) progress->stage = "encoding";
  std::vector<OutgoingChunk> chunks;
  for (outline::Pass* pass : {&outlines, &inner}) {
    std::vector<outline::Finished> finished;
    if (!pass->encode(options.threads, progress, finished))
      return EncodeError{pass->too_long ? "a polygon exceeds a chunk" : "cancelled"};
    outline::append_chunks(std::move(finished), pass == &inner, bits, chunks);
    pass->pool = {};
  }
  return write_stream(std::move(header), std::move(chunks), options.max_bytes);
}

}  // namespace gs::qnv
