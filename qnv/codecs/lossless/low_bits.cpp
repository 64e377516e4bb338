#include "qnv/codecs/lossless/low_bits.h"

#include "base/bytes.h"

#include <algorithm>
#include <utility>

namespace gs::qnv::exact {
namespace {

constexpr std::size_t kLowBitsHeaderBytes = 5, kLowBitsBytes = 1185, kMaxLowBitsBytes = std::size_t{1} << 28;
constexpr std::size_t kRunCost = 64;  // overhead in bytes of one run of vertices
constexpr std::size_t kBits = 3;  // bits per vertex and layer

bool bit_at(std::span<const std::byte> bytes, std::size_t at) {
  return (std::to_integer<unsigned>(bytes[at / 8]) >> (7 - at % 8) & 1) != 0;
}

}  // namespace

std::vector<std::vector<std::byte>> low_bits_of(const ExactMesh& mesh, int bits,
                                                std::span<const std::uint32_t> numbers) {
  std::vector<std::uint32_t> order;
  order.resize(numbers.size(), displaced::kNone);
  std::size_t count = 0;
  for (std::uint32_t v = 0; v < numbers.size(); ++v)
    if (numbers[v] != displaced::kNone) {
      order[numbers[v]] = v;
      ++count;
    }
  std::vector<std::vector<std::byte>> payloads;
  constexpr std::size_t kVertices = 8 * kLowBitsBytes / kBits;
  for (int layer = 0; layer < mesh.bits - bits; ++layer)
    for (std::size_t first = 0; first < count; first += kVertices) {
      std::vector<std::byte>& payload = payloads.emplace_back();
      ByteWriter out(payload);
      out.integer(static_cast<std::uint8_t>(layer));
      out.integer(static_cast<std::uint32_t>(first));
      const std::size_t here = std::min(kVertices, count - first);
      payload.resize(kLowBitsHeaderBytes + (kBits * here + 7) / 8);
      const int shift = mesh.bits - bits - 1 - layer;
      for (std::size_t i = 0; i < kBits * here; ++i)
        if ((mesh.vertices[order[first + i / kBits]][static_cast<int>(i % kBits)] >> shift & 1) != 0)
          payload[kLowBitsHeaderBytes + i / 8] |= static_cast<std::byte>(128u >> (i % 8));
    }
  return payloads;
}

bool LowBits::add(std::span<const std::byte> payload) {
  ByteReader in(payload);
  const int layer = in.integer<std::uint8_t>();
  const auto first = in.integer<std::uint32_t>();
  if (!in.good() || layer > kMaxBits || payload.size() == kLowBitsHeaderBytes) return false;
  if (runs_.contains({layer, first})) return true;
  bytes_ += payload.size() + kRunCost;
  if (bytes_ > kMaxLowBitsBytes) return false;
  const auto bytes = payload.subspan(kLowBitsHeaderBytes);
  runs_.emplace(std::pair(layer, first), std::vector<std::byte>(bytes.begin(), bytes.end()));
  return true;
}

bool LowBits::complete(const ExactMesh& mesh) const {
  const int more = std::max(0, mesh.finest - mesh.bits);
  std::size_t come = 0;
  for (const auto& [where, bytes] : runs_)
    if (where.first < more && where.second < mesh.vertices.size())
      come += std::min(8 * bytes.size() / kBits, mesh.vertices.size() - where.second);
  return come >= static_cast<std::size_t>(more) * mesh.vertices.size();
}

void LowBits::apply(ExactMesh& mesh) const {
  const int more = std::max(0, mesh.finest - mesh.bits);
  if (more == 0) return;
  std::vector<std::uint8_t> known(mesh.vertices.size(), 0);  // number of layers received without a gap, for each vertex
  for (const auto& [where, bytes] : runs_) {
    const auto& [layer, first] = where;
    const std::size_t here = 8 * bytes.size() / kBits;
    for (std::size_t i = 0; i < here && first + i < mesh.vertices.size(); ++i) {
      const std::size_t v = first + i;
      if (known[v] != layer || layer >= more) continue;
      ++known[v];
      for (int axis = 0; axis < 3; ++axis)
        mesh.vertices[v][axis] =
            2 * mesh.vertices[v][axis] + (bit_at(bytes, kBits * i + static_cast<std::size_t>(axis)) ? 1 : 0);
    }
  }
  for (std::size_t v = 0; v < known.size(); ++v) {
    const int less = more - known[v];
    for (int axis = 0; axis < 3; ++axis)
      mesh.vertices[v][axis] = mesh.vertices[v][axis] << less | (less > 0 ? 1 << (less - 1) : 0);
  }
  mesh.bits = mesh.finest;
}

}  // namespace gs::qnv::exact
