#include "qnv/codecs/lossless/encode/surface_tail.h"

#include "qnv/codecs/lossless/low_bits.h"
#include "qnv/codecs/lossless/own_normals.h"
#include "qnv/codecs/lossless/tail_pieces.h"
#include "qnv/container/piece_group.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <span>
#include <utility>

namespace gs::qnv {
namespace {

// For automatically chosen bits: lattice positions per mean edge, and the minimum and maximum bits.
constexpr float kPlacesAnEdge = 96;
constexpr int kMinChosenBits = 11, kMaxChosenBits = 14;
// With parity: minimum and maximum bytes per piece of a tail, approximate number of pieces, and bytes of a parity
// group.
constexpr std::size_t kMinReadTogether = 512, kMaxReadTogether = 4096, kReads = 24,
                      kGroupBytes = 120 * kAimedPieceBytes;
// Without parity: minimum bytes per piece, and approximate number of pieces.
constexpr std::size_t kMinTailPiece = 4096, kTailPieces = 12;
// Number of parity pieces for n pieces: kGroupParity * n + kGroupParityRoot * sqrt(n) + 1. At 30 % loss, 99 of 100
// groups survive (mean of a binomial distribution plus 2.3 deviations).
constexpr double kGroupParity = 0.43, kGroupParityRoot = 1.9;
// Angle in degrees. Below it, Rule::faces shades faces separately.
constexpr int kFacesApart = 30;
// Maximum growth of the total size that is accepted for fewer bits in the tail.
constexpr double kWorthOfFewBits = 1.01;

// Root mean square difference of unit normals (0.035 is 2 degrees). Above it, the stream contains the normals of the
// source.
constexpr double kNormalsApart = 0.035;
// Texture lattice: log2 of the lattice positions per pixel, and the minimum bits.
constexpr int kTexelBits = 1, kMinTextureBits = 8;

float mean_edge_of(const displaced::SurfaceMesh& mesh) {
  double sum = 0;
  for (const displaced::Corners& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k)
      sum += static_cast<double>(glm::length(mesh.positions[t[k]] - mesh.positions[t[(k + 1) % 3]]));
  return static_cast<float>(sum / std::max(1.0, 3.0 * static_cast<double>(mesh.triangles.size())));
}

/// Returns the mesh with positions truncated to `bits` bits.
exact::ExactMesh coarser(const exact::ExactMesh& mesh, int bits) {
  exact::ExactMesh coarse = mesh;
  coarse.bits = std::min(bits, mesh.bits);
  coarse.finest = mesh.bits;
  for (glm::ivec3& p : coarse.vertices) p >>= mesh.bits - coarse.bits;
  return coarse;
}

/// Returns the encoded normals of a source. Returns an empty list if the shading rule reproduces them well enough.
/// `coarse` is the mesh with the positions of the tail, `order` its decoding order.
std::vector<std::byte> own_normals_of(const exact::ExactMesh& mesh, const exact::ExactMesh& coarse,
                                      std::span<const std::byte> tail, const exact::TailOrder& order) {
  if (mesh.normals.empty()) return {};
  {
    exact::ExactMesh joined = mesh;
    joined.twins = exact::twins_of(joined.triangles);
    const std::vector<glm::vec3> shaded = exact::shaded_normals(joined, mesh.shading);
    std::vector<glm::vec3> own = shaded;
    for (std::size_t c = 0; c < own.size(); ++c)
      if (const glm::vec3& normal = mesh.normals[c / 3][c % 3]; normal != glm::vec3(0)) own[c] = normal;
    if (exact::distance_of(shaded, own) < kNormalsApart) return {};
  }
  auto decoded = exact::decode_tail(tail, coarse.vertices.size());
  if (!decoded || order.triangles.size() != decoded->triangles.size()) return {};
  const std::vector<glm::vec3> shaded =
      exact::shaded_normals(*decoded, {exact::Shading::Rule::edges, decoded->crease_angle});
  std::vector<glm::vec3> own = shaded;
  for (std::size_t t = 0; t < decoded->triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t j = 0; j < 3; ++j) {
        const std::uint32_t source = order.triangles[t];
        const glm::vec3& normal = mesh.normals[source][j];
        if (order.vertices[mesh.triangles[source][j]] == decoded->triangles[t][k] && normal != glm::vec3(0))
          own[3 * t + k] = normal;
      }
  return exact::encode_normals(*decoded, shaded, own);
}

/// Payloads in pieces, and their parity pieces. They form as many groups as necessary, at most kGroups.
struct Pieces {
  std::vector<std::vector<std::byte>> data, parity;
};
constexpr int kGroups = 16;
constexpr std::size_t kMaxWithParity = std::size_t{6} << 20;  // capacity of kGroups groups, in bytes
Pieces pieces_with_parity(int group, std::span<const std::vector<std::byte>> payloads) {
  std::size_t all = 0;
  for (const auto& payload : payloads) all += payload.size();
  const std::size_t groups = std::clamp<std::size_t>((all + kGroupBytes - 1) / kGroupBytes, 1, kGroups);
  const std::size_t aimed = std::max(kAimedPieceBytes, all / groups / 120);
  Pieces out;
  for (std::size_t i = 0, first = 0; i < groups; ++i) {
    const std::size_t last = payloads.size() * (i + 1) / groups;
    std::size_t bytes = 0;
    for (std::size_t k = first; k < last; ++k) bytes += payloads[k].size();
    const double pieces = static_cast<double>(bytes) / static_cast<double>(aimed);
    CutGroup cut = cut_group(group + static_cast<int>(i), payloads.subspan(first, last - first), kGroupParity,
                             static_cast<std::size_t>(std::ceil(kGroupParityRoot * std::sqrt(pieces))) + 1, aimed);
    std::ranges::move(cut.data, std::back_inserter(out.data));
    std::ranges::move(cut.parity, std::back_inserter(out.parity));
    first = last;
  }
  return out;
}

}  // namespace

exact::ExactMesh exact_mesh_of(const displaced::MeshBuilder& builder, const displaced::Frame& frame, bool colored,
                               int bits) {
  displaced::SurfaceMesh all = builder.welded();
  for (glm::vec3& p : all.positions) p = frame.inside(p);
  if (!colored) all.colors.clear();
  if (bits == 0) {
    const float edge = mean_edge_of(all);
    bits = kMinChosenBits;
    while (bits < kMaxChosenBits && edge * static_cast<float>(1 << bits) < kPlacesAnEdge) ++bits;
  }
  return exact::quantized(std::move(all), bits);
}

exact::ExactMesh exact_mesh_of(const TexturedSurface& surface, const displaced::Frame& frame, int bits) {
  displaced::MeshBuilder builder(false);
  std::vector<std::array<glm::vec2, 3>> kept;  // corners of the triangles with an area
  glm::vec2 lower(std::numeric_limits<float>::max()), upper(std::numeric_limits<float>::lowest());
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const std::size_t before = builder.triangles();
    builder.add(std::span(surface.triangles).subspan(t, 1));
    if (builder.triangles() == before) continue;
    kept.push_back(surface.coordinates[t]);
    for (const glm::vec2& at : kept.back()) {
      lower = glm::min(lower, at);
      upper = glm::max(upper, at);
    }
  }
  exact::ExactMesh mesh = exact_mesh_of(builder, frame, false, bits);
  if (kept.empty()) return mesh;
  exact::TextureLattice& lattice = mesh.texture;
  lattice.lower = lower;
  lattice.size = glm::max(upper - lower, glm::vec2(std::numeric_limits<float>::min()));
  const glm::vec2 pixels =
      lattice.size * glm::vec2(static_cast<float>(surface.width), static_cast<float>(surface.height));
  const float most = std::min(std::max(pixels.x, pixels.y), 65536.0f);
  lattice.bits = std::clamp(static_cast<int>(std::ceil(std::log2(std::max(most, 1.0f)))) + kTexelBits, kMinTextureBits,
                            exact::kMaxTextureBits);
  const auto top = static_cast<float>(lattice.top());
  mesh.coordinates.reserve(kept.size());
  for (const auto& corners : kept) {
    exact::CornerCoordinates& on = mesh.coordinates.emplace_back();
    for (std::size_t k = 0; k < 3; ++k)
      on[k] = glm::ivec2(glm::clamp(glm::floor((corners[k] - lattice.lower) / lattice.size * top + 0.5f), 0.0f, top));
  }
  return mesh;
}

SurfaceTail tail_of(const exact::ExactMesh& mesh, int bits, const exact::TailRanks* ranks, exact::TailOrder* order) {
  SurfaceTail tail;
  tail.vertices = mesh.vertices.size();
  tail.shading = mesh.shading;
  const exact::ExactMesh coarse = coarser(mesh, bits);
  exact::TailOrder own;
  if (!order) order = &own;
  tail.bytes = exact::encode_tail(coarse, false, ranks, order);
  tail.low_bits = exact::low_bits_of(mesh, coarse.bits, order->vertices);
  for (const auto& payload : tail.low_bits) tail.low_bytes += payload.size();
  tail.normals = own_normals_of(mesh, coarse, tail.bytes, *order);
  return tail;
}

void set_picture(SurfaceTail& tail, const TexturedSurface& surface) {
  const exact::TailPicture picture{surface.picture, surface.repeat_s, surface.repeat_t};
  tail.picture = exact::encode_picture(picture);
  tail.picture_first = exact::bytes_until_shown(picture, 0);
  tail.picture_fine = exact::bytes_until_shown(picture, picture.files.size() - 1);
}

std::size_t rough_tail_size(const exact::ExactMesh& mesh, int bits) {
  const exact::ExactMesh coarse = coarser(mesh, bits);
  const std::size_t low = 3 * mesh.vertices.size() * static_cast<std::size_t>(mesh.bits - coarse.bits) / 8;
  return exact::encode_tail(coarse, true).size() + low;
}

int first_tail_bits(const exact::ExactMesh& mesh) {
  // Errors of positions affect flat face normals more than the mean normal around a corner.
  const bool apart = mesh.shading.rule == exact::Shading::Rule::faces && mesh.shading.angle < kFacesApart;
  return apart ? kTailBits : kTailBits - 1;
}

int fewest_tail_bits(const exact::ExactMesh& mesh) {
  int best = std::min(kTailBits, mesh.bits);
  auto least = static_cast<double>(rough_tail_size(mesh, best));
  for (int bits = best + 1; bits <= mesh.bits; ++bits) {
    const auto size = static_cast<double>(rough_tail_size(mesh, bits));
    if (size * kWorthOfFewBits > least) break;
    best = bits;
    least = size;
  }
  return best;
}

void append_tail(const SurfaceTail& tail, const Box& box, std::vector<OutgoingChunk>& others) {
  std::uint32_t replaced = 0;
  for (const OutgoingChunk& chunk : others) replaced += chunk.entry.vectors;
  const auto append = [&](ChunkType type, std::vector<std::byte> payload) {
    OutgoingChunk& chunk = others.emplace_back();
    chunk.type = type;
    chunk.entry.parent = 0xffffffff;
    chunk.entry.box = box;
    chunk.payload = std::move(payload);
  };
  const auto append_shading = [&] {
    if (tail.shading.rule != exact::Shading::Rule::edges)
      append(ChunkType::shading, exact::encode_shading(tail.shading));
  };
  append_shading();
  if (tail.cover) append(ChunkType::cover, exact::encode_cover(*tail.cover));
  const std::size_t most = tail.cover
                               ? std::clamp(tail.bytes.size() / kTailPieces, kMinTailPiece, exact::kTailPieceBytes)
                               : exact::kTailPieceBytes;
  const std::size_t together = std::clamp(tail.bytes.size() / kReads, kMinReadTogether, kMaxReadTogether);
  std::vector<std::vector<std::byte>> payloads = exact::pieces_of(tail.bytes, tail.parity ? together : most);
  Pieces pieces, low{tail.low_bits, {}};
  if (tail.parity) {
    pieces = pieces_with_parity(kGroupsOfTails, payloads);
    if (!tail.low_bits.empty()) low = pieces_with_parity(kGroupsOfLowBits, tail.low_bits);
  } else {
    pieces.data = std::move(payloads);
  }
  // Sends the drawable first part of the texture before the mesh, because the mesh is not drawn without it.
  Pieces picture;
  const bool picture_parity = tail.parity && tail.picture.size() <= kMaxWithParity;
  picture.data = exact::pieces_of(tail.picture, picture_parity ? together : kMinTailPiece);
  if (picture_parity && !picture.data.empty()) picture = pieces_with_parity(kGroupsOfPictures, picture.data);
  std::size_t sent = 0, picture_bytes = 0;
  const auto append_picture = [&](std::size_t until) {
    for (; sent < picture.data.size() && picture_bytes < until; ++sent) {
      picture_bytes += picture.data[sent].size();
      append(picture_parity ? ChunkType::piece : ChunkType::picture, std::move(picture.data[sent]));
    }
  };
  append_picture(tail.picture_first);
  for (std::vector<std::byte>& piece : pieces.data)
    append(tail.parity ? ChunkType::piece : ChunkType::exact, std::move(piece));
  OutgoingChunk& last = others.back();
  last.entry.vectors = static_cast<std::uint32_t>(tail.vertices);
  last.replaced = std::min(replaced, last.entry.vectors);
  Pieces normals;
  const bool normals_parity = tail.parity && tail.normals.size() <= kMaxWithParity;
  normals.data = exact::pieces_of(tail.normals, normals_parity ? together : kMinTailPiece);
  if (normals_parity && !normals.data.empty()) normals = pieces_with_parity(kGroupsOfNormals, normals.data);
  append_picture(tail.picture_fine);
  for (std::vector<std::byte>& piece : normals.data)
    append(normals_parity ? ChunkType::piece : ChunkType::normals, std::move(piece));
  append_picture(std::numeric_limits<std::size_t>::max());
  for (std::vector<std::byte>& piece : low.data)
    append(tail.parity ? ChunkType::piece : ChunkType::low_bits, std::move(piece));
  // Repeats these two bytes in another packet, because they change the shading of the whole mesh.
  if (tail.parity) append_shading();
  for (auto* parity : {&picture.parity, &pieces.parity, &normals.parity, &low.parity})
    for (std::vector<std::byte>& piece : *parity) append(ChunkType::piece, std::move(piece));
  if (tail.parity) append_shading();
}

}  // namespace gs::qnv
