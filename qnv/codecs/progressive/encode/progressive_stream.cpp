#include "qnv/codecs/progressive/encode/progressive_stream.h"

#include "qnv/codecs/lossless/encode/surface_tail.h"
#include "qnv/codecs/progressive/progressive.h"
#include "qnv/codecs/shared/stream_writer.h"
#include "qnv/codecs/shared/surface_header.h"
#include "qnv/container/piece_group.h"

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace gs::qnv {
namespace {

// Parity relative to the data pieces; another constant number of pieces is added. At 30 % loss, one mesh in a hundred
// is lost.
constexpr double kSplitParity = 0.75;
constexpr std::size_t kSplitParityBesides = 3;
// Bytes of a piece near the start of the stream, and the number of bytes that count as near the start.
constexpr std::size_t kSmallPieceBytes = 480, kSmallPiecesUntil = 3000;
// Maximum number of triangles. With more, the first mesh would be too coarse.
constexpr std::size_t kMaxGrowingTriangles = 100'000;

/// Returns the segments of a progressive mesh as pieces with parity, so that losses do not stop its growth.
std::vector<OutgoingChunk> chunks_of(const progressive::ProgressiveBytes& mesh, const Box& box) {
  // Uses small pieces near the start, where every byte counts: a truncated piece is useless.
  std::size_t few = 0;
  for (std::size_t bytes = 0; few < mesh.segments.size() && bytes < kSmallPiecesUntil; ++few)
    bytes += mesh.segments[few].size();
  const std::span<const std::vector<std::byte>> all(mesh.segments);
  CutGroup front, rest;
  if (few > 0) front = cut_group(kGroupsOfSplits, all.first(few), kSplitParity, kSplitParityBesides, kSmallPieceBytes);
  if (few < all.size()) rest = cut_group(kGroupsOfSplits + 1, all.subspan(few), kSplitParity, kSplitParityBesides);
  std::vector<OutgoingChunk> chunks;
  const std::size_t data = front.data.size() + rest.data.size();
  for (auto* pieces : {&front.data, &rest.data, &front.parity, &rest.parity})
    for (std::vector<std::byte>& piece : *pieces) {
      OutgoingChunk& chunk = chunks.emplace_back();
      chunk.type = ChunkType::piece;
      chunk.entry.parent = 0xffffffff;
      chunk.entry.box = box;
      const std::size_t n = chunks.size();  // each chunk gets about the same number of vertices
      if (n <= data)
        chunk.entry.vectors = static_cast<std::uint32_t>(mesh.vertices * n / data - mesh.vertices * (n - 1) / data);
      chunk.payload = std::move(piece);
    }
  return chunks;
}

}  // namespace

std::optional<EncodedStream> encode_splits(const exact::ExactMesh& mesh, StreamHeader header, std::size_t max_bytes) {
  auto splits = progressive::encode_progressive(mesh, room_for_base(header));
  if (!splits) return std::nullopt;
  const Box box = header.description.box;
  header.base = std::move(splits->front);
  return write_stream(std::move(header), chunks_of(*splits, box), max_bytes);
}

std::variant<EncodedStream, EncodeError> encode_progressive(const TriangleSource& source, const EncodeOptions& options,
                                                            Progress* progress) {
  if (progress) progress->stage = "reading";
  SurfaceSurvey s;
  displaced::MeshBuilder builder(true);
  const bool read = source([&](std::span<const Triangle> triangles) {
    s.add(triangles);
    builder.add(triangles);
    return s.triangles <= kMaxGrowingTriangles && !is_cancelled(progress);
  });
  if (s.triangles > kMaxGrowingTriangles)
    return EncodeError{"the surface has too many triangles to grow by splits; expected at most " +
                           std::to_string(kMaxGrowingTriangles),
                       true};
  if (!read) return EncodeError{is_cancelled(progress) ? "cancelled" : "the surface cannot be read"};
  if (!s.sound()) return EncodeError{"no surface to encode; expected triangles with an area"};
  const exact::ExactMesh mesh = exact_mesh_of(builder, displaced::Frame(s.box), s.colored, kProgressiveBits);
  auto stream = encode_splits(mesh, surface_header(Payload::displaced, s, options), options.max_bytes);
  if (!stream) return EncodeError{"the surface does not begin with a small mesh of one colour", true};
  return std::move(*stream);
}

}  // namespace gs::qnv
