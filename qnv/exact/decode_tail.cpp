#include "qnv/base/bytes.h"
#include "qnv/exact/exact_header.h"
#include "qnv/exact/exact_tail.h"

#include <cstdint>
#include <utility>

namespace gs::qnv::exact {
namespace {

/// What reads is told nothing.
struct NoGuide {};

std::size_t header_bytes(std::span<const std::byte> tail, const TailHeader& header) {
  const bool finer = (std::to_integer<int>(tail[0]) & 4) != 0;
  return kTailFixedBytes + (finer ? 1 : 0) + (header.usual ? 0 : kTailWeightsBytes);
}

}  // namespace

std::vector<std::byte> encode_tail_header(const TailHeader& header) {
  std::vector<std::byte> bytes;
  ByteWriter out(bytes);
  out.integer(static_cast<std::uint8_t>((header.colored ? 1 : 0) + (header.usual ? 2 : 0) +
                                        (header.finest > header.bits ? 4 : 0)));
  out.integer(static_cast<std::uint8_t>(header.bits));
  out.integer(static_cast<std::uint8_t>(header.crease_angle));
  out.integer(header.vertices);
  out.integer(header.triangles);
  if (header.finest > header.bits) out.integer(static_cast<std::uint8_t>(header.finest));
  for (const auto& situation : header.usual ? std::span<const Weights::value_type>() : std::span(header.weights))
    for (const std::int16_t weight : situation) out.integer(weight);
  return bytes;
}

std::optional<TailHeader> decode_tail_header(std::span<const std::byte> tail) {
  ByteReader in(tail);
  TailHeader header;
  const auto flags = in.integer<std::uint8_t>();
  header.colored = (flags & 1) != 0;
  header.bits = in.integer<std::uint8_t>();
  header.crease_angle = in.integer<std::uint8_t>();
  header.vertices = in.integer<std::uint32_t>();
  header.triangles = in.integer<std::uint32_t>();
  header.finest = (flags & 4) != 0 ? in.integer<std::uint8_t>() : header.bits;
  header.usual = (flags & 2) != 0;
  header.weights = kUsualWeights;
  for (auto& situation : header.usual ? std::span<Weights::value_type>() : std::span(header.weights))
    for (std::int16_t& weight : situation) weight = in.integer<std::int16_t>();
  if (!in.good() || flags > 7 || header.finest < header.bits || header.finest > kMostBits || header.bits < kLeastBits || header.bits > kMostBits || header.crease_angle > 180 ||
      header.triangles == 0 || header.triangles > kMostTrianglesAByte * tail.size() ||
      header.vertices / 3 > header.triangles)
    return {};
  return header;
}

std::optional<TailSize> tail_size(std::span<const std::byte> tail) {
  const auto header = decode_tail_header(tail);
  if (!header) return {};
  return TailSize{header->bits, header->vertices, header->triangles};
}

std::optional<ExactMesh> decode_tail(std::span<const std::byte> bytes, std::size_t most_vertices) {
  const auto header = decode_tail_header(bytes);
  if (!header || header->vertices > most_vertices || header->triangles / 2 > most_vertices) return {};
  displaced::BinaryDecoder decoder(bytes.subspan(header_bytes(bytes, *header)));
  NoGuide guide;
  MeshGrowth<displaced::BinaryDecoder, NoGuide> growth(decoder, *header, guide);
  if (!growth.run()) return {};
  ExactMesh mesh;
  mesh.bits = header->bits;
  mesh.finest = header->finest;
  mesh.crease_angle = header->crease_angle;
  mesh.vertices = growth.take_places();
  mesh.twins = growth.twins();
  mesh.triangles = growth.take_triangles();
  mesh.colors.resize(growth.colors().size());
  for (std::size_t v = 0; v < mesh.colors.size(); ++v) (void)color_of(growth.colors()[v], mesh.colors[v]);
  return mesh;
}

}  // namespace gs::qnv::exact
