#include "base/bytes.h"
#include "qnv/codecs/lossless/decode/tail_reader.h"
#include "qnv/codecs/lossless/exact_header.h"
#include "qnv/codecs/lossless/exact_tail.h"

#include <glm/vec2.hpp>

#include <cmath>
#include <cstdint>
#include <utility>

namespace gs::qnv::exact {
std::vector<std::byte> encode_tail_header(const TailHeader& header) {
  std::vector<std::byte> bytes;
  ByteWriter out(bytes);
  out.integer(static_cast<std::uint8_t>((header.colored ? 1 : 0) + (header.usual ? 2 : 0) +
                                        (header.finest > header.bits ? 4 : 0) + (header.cell_bits > 0 ? 8 : 0) +
                                        (header.texture.bits > 0 ? 16 : 0)));
  out.integer(static_cast<std::uint8_t>(header.bits));
  out.integer(static_cast<std::uint8_t>(header.crease_angle));
  out.integer(header.vertices);
  out.integer(header.triangles);
  if (header.finest > header.bits) out.integer(static_cast<std::uint8_t>(header.finest));
  if (header.cell_bits > 0) out.integer(static_cast<std::uint8_t>(header.cell_bits));
  if (header.texture.bits > 0) {
    out.integer(static_cast<std::uint8_t>(header.texture.bits));
    for (const glm::vec2& v : {header.texture.lower, header.texture.size})
      for (int axis = 0; axis < 2; ++axis) out.f32(v[axis]);
  }
  for (const auto& situation : header.usual ? std::span<const Weights::value_type>() : std::span(header.weights))
    for (const std::int16_t weight : situation) out.integer(weight);
  return bytes;
}

std::size_t tail_header_bytes(std::span<const std::byte> tail) {
  if (tail.empty()) return 0;
  const unsigned flags = std::to_integer<unsigned>(tail[0]);
  return kTailFixedBytes + (flags >> 2 & 1) + (flags >> 3 & 1) + (flags >> 4 & 1) * kTextureLatticeBytes +
         ((flags & 2) != 0 ? 0 : kTailWeightsBytes);
}

std::optional<TailHeader> decode_tail_header(std::span<const std::byte> tail, std::size_t length) {
  ByteReader in(tail);
  TailHeader header;
  const auto flags = in.integer<std::uint8_t>();
  header.colored = (flags & 1) != 0;
  header.bits = in.integer<std::uint8_t>();
  header.crease_angle = in.integer<std::uint8_t>();
  header.vertices = in.integer<std::uint32_t>();
  header.triangles = in.integer<std::uint32_t>();
  header.finest = (flags & 4) != 0 ? in.integer<std::uint8_t>() : header.bits;
  header.cell_bits = (flags & 8) != 0 ? in.integer<std::uint8_t>() : 0;
  bool lies = true;  // the texture lattice is valid and finite
  if ((flags & 16) != 0) {
    header.texture.bits = in.integer<std::uint8_t>();
    for (glm::vec2* v : {&header.texture.lower, &header.texture.size})
      for (int axis = 0; axis < 2; ++axis) (*v)[axis] = in.f32();
    const glm::vec2 upper = header.texture.lower + header.texture.size;
    lies = header.texture.bits >= 1 && header.texture.bits <= kMaxTextureBits && std::isfinite(upper.x) &&
           std::isfinite(upper.y) && header.texture.size.x >= 0 && header.texture.size.y >= 0;
  }
  header.usual = (flags & 2) != 0;
  header.weights = kUsualWeights;
  for (auto& situation : header.usual ? std::span<Weights::value_type>() : std::span(header.weights))
    for (std::int16_t& weight : situation) weight = in.integer<std::int16_t>();
  if (!in.good() || flags > 31 || !lies || header.bits < kMinBits || header.bits > kMaxBits ||
      header.finest < header.bits || header.finest > kMaxBits || header.cell_bits > kMaxCellBits ||
      ((flags & 8) != 0 && header.cell_bits == 0) || header.crease_angle > 180 || header.triangles == 0 ||
      header.triangles > kMaxTrianglesAByte * length || header.vertices / 3 > header.triangles)
    return {};
  return header;
}

std::optional<ExactMesh> decode_tail(std::span<const std::byte> bytes, std::size_t most_vertices) {
  TailReader reader(bytes.size(), most_vertices);
  reader.push(bytes);
  if (reader.state() != TailReader::State::whole) return {};
  return reader.mesh();
}

}  // namespace gs::qnv::exact
