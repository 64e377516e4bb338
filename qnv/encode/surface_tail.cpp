#include "qnv/encode/surface_tail.h"

#include "qnv/exact/low_bits.h"
#include "qnv/exact/tail_pieces.h"
#include "qnv/stream/piece_group.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <span>
#include <utility>

namespace gs::qnv {
namespace {

// An edge of the mean length has so many places of a lattice that is chosen; between so many bits.
constexpr float kPlacesAnEdge = 96;
constexpr int kFewestChosenBits = 11, kMostChosenBits = 14;
// With parity: bytes of a tail that are read at once, between these and about so many times, and of what parity stands for together.
constexpr std::size_t kLeastReadTogether = 512, kMostReadTogether = 4096, kReads = 24, kGroupBytes = 120 * kAimedPieceBytes;
// Else, of a tail's pieces.
constexpr std::size_t kLeastTailPiece = 4096, kTailPieces = 12;
// Parity of n pieces is this part of n, and this times its root besides: with 30 % lost they all come back in 99 of 100
// cases (the mean of a binomial distribution and 2.3 of its deviations).
constexpr double kGroupParity = 0.43, kGroupParityRoot = 1.9;
// Faces that are no farther apart are shaded by themselves where the angle is less, degrees.
constexpr int kFacesApart = 30;
// Fewer bits in the tail are worth so much of its bytes.
constexpr double kWorthOfFewBits = 1.01;

float mean_edge_of(const displaced::SurfaceMesh& mesh) {
  double sum = 0;
  for (const displaced::Corners& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k)
      sum += static_cast<double>(glm::length(mesh.positions[t[k]] - mesh.positions[t[(k + 1) % 3]]));
  return static_cast<float>(sum / std::max(1.0, 3.0 * static_cast<double>(mesh.triangles.size())));
}

/// The same with fewer bits.
exact::ExactMesh coarser(const exact::ExactMesh& mesh, int bits) {
  exact::ExactMesh coarse = mesh;
  coarse.bits = std::min(bits, mesh.bits);
  coarse.finest = mesh.bits;
  for (glm::ivec3& p : coarse.vertices) p >>= mesh.bits - coarse.bits;
  return coarse;
}

/// Payloads in pieces with parity, in as many groups as it takes, as far as there are.
struct Pieces {
  std::vector<std::vector<std::byte>> data, parity;
};
Pieces pieces_with_parity(int group, std::span<const std::vector<std::byte>> payloads) {
  constexpr int kGroups = 16;
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
    bits = kFewestChosenBits;
    while (bits < kMostChosenBits && edge * static_cast<float>(1 << bits) < kPlacesAnEdge) ++bits;
  }
  return exact::quantized(std::move(all), bits);
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
  return tail;
}

std::size_t rough_tail_size(const exact::ExactMesh& mesh, int bits) {
  const exact::ExactMesh coarse = coarser(mesh, bits);
  const std::size_t low = 3 * mesh.vertices.size() * static_cast<std::size_t>(mesh.bits - coarse.bits) / 8;
  return exact::encode_tail(coarse, true).size() + low;
}

int first_tail_bits(const exact::ExactMesh& mesh) {
  // Normals of faces by themselves are further off than means of those around a corner.
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
  const std::size_t most = tail.cover ? std::clamp(tail.bytes.size() / kTailPieces, kLeastTailPiece, exact::kTailPieceBytes)
                                      : exact::kTailPieceBytes;
  const std::size_t together = std::clamp(tail.bytes.size() / kReads, kLeastReadTogether, kMostReadTogether);
  std::vector<std::vector<std::byte>> payloads = exact::pieces_of(tail.bytes, tail.parity ? together : most);
  Pieces pieces, low{tail.low_bits, {}};
  if (tail.parity) {
    pieces = pieces_with_parity(kGroupsOfTails, payloads);
    if (!tail.low_bits.empty()) low = pieces_with_parity(kGroupsOfLowBits, tail.low_bits);
  } else {
    pieces.data = std::move(payloads);
  }
  for (std::vector<std::byte>& piece : pieces.data)
    append(tail.parity ? ChunkType::piece : ChunkType::exact, std::move(piece));
  OutgoingChunk& last = others.back();
  last.entry.vectors = static_cast<std::uint32_t>(tail.vertices);
  last.replaced = std::min(replaced, last.entry.vectors);
  for (std::vector<std::byte>& piece : low.data)
    append(tail.parity ? ChunkType::piece : ChunkType::low_bits, std::move(piece));
  // Two bytes without which all of the mesh looks otherwise: again where other packets hold them.
  if (tail.parity) append_shading();
  for (auto* parity : {&pieces.parity, &low.parity})
    for (std::vector<std::byte>& piece : *parity) append(ChunkType::piece, std::move(piece));
  if (tail.parity) append_shading();
}

}  // namespace gs::qnv
