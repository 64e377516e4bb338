#include "qnv/codecs/lossless/own_normals.h"

#include "base/bytes.h"
#include "qnv/codecs/lossless/exact_numbers.h"
#include "qnv/codecs/lossless/shading.h"

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

namespace gs::qnv::exact {
namespace {

using displaced::kNone;

constexpr std::size_t kNormalsHeaderBytes = 5;
constexpr std::uint32_t kNormalsEnd = 0x4e51;
// Maximum distance between two normals that count as equal, in quantisation steps.
constexpr float kStepsTogether = 2.5f;

/// Directions as points of a square (octahedral coordinates): 0 to 2^bits - 1 per axis.
class Square {
 public:
  explicit Square(int bits) : top_(static_cast<float>((1 << bits) - 1)) {}
  [[nodiscard]] int top() const { return static_cast<int>(top_); }
  [[nodiscard]] glm::ivec2 point_of(glm::vec3 n) const {
    n /= std::max(std::abs(n.x) + std::abs(n.y) + std::abs(n.z), 1e-20f);
    glm::vec2 p(n.x, n.y);
    if (n.z < 0) p = {std::copysign(1 - std::abs(n.y), n.x), std::copysign(1 - std::abs(n.x), n.y)};
    const auto part = [&](float c) {
      return static_cast<int>(std::clamp(std::floor((c + 1) / 2 * top_ + 0.5f), 0.0f, top_));
    };
    return {part(p.x), part(p.y)};
  }
  [[nodiscard]] glm::vec3 direction_of(const glm::ivec2& q) const {
    const glm::vec2 p = glm::vec2(q) / top_ * 2.0f - 1.0f;
    glm::vec3 n(p.x, p.y, 1 - std::abs(p.x) - std::abs(p.y));
    if (n.z < 0) n = {std::copysign(1 - std::abs(p.y), p.x), std::copysign(1 - std::abs(p.x), p.y), n.z};
    return glm::normalize(n);
  }

 private:
  float top_;
};

/// Coder of normals. The same code encodes and decodes. `own` holds the normals for an encoder; a decoder ignores it.
template <class Coder>
class NormalCoder {
 public:
  NormalCoder(Coder& coder, const ExactMesh& mesh, std::span<const glm::vec3> shaded, std::span<const glm::vec3> own,
              int bits)
      : decisions_(coder),
        mesh_(mesh),
        shaded_(shaded),
        own_(own),
        square_(bits),
        together_(std::cos(kStepsTogether * 2.0f / static_cast<float>(square_.top()))) {}

  /// Codes all normals. Returns false if the bytes are invalid.
  bool run() {
    normals_.resize(shaded_.size());
    offs_.assign(mesh_.vertices.size(), 4);
    for (std::uint32_t corner = 0; corner < shaded_.size(); ++corner) {
      if (!code(corner)) return false;
      if (corner % 1024 == 0 && !decisions_.good()) return false;
    }
    return decisions_.bits(kNormalsEnd, 16) == kNormalsEnd && decisions_.good();
  }
  [[nodiscard]] std::vector<glm::vec3>& normals() { return normals_; }

 private:
  static constexpr bool kWrites = Decisions<Coder>::kWrites;

  /// Returns the normal at the same vertex in the adjacent triangle. Returns nullptr if that triangle is missing or not
  /// coded yet.
  [[nodiscard]] const glm::vec3* beside(std::uint32_t side, std::uint32_t step, std::uint32_t corner) const {
    const std::uint32_t twin = mesh_.twins[side];
    if (twin == kNone || twin / 3 >= corner / 3) return nullptr;
    return &normals_[twin / 3 * 3 + (twin % 3 + step) % 3];
  }
  bool code(std::uint32_t corner) {
    const std::uint32_t t = corner / 3, k = corner % 3;
    const std::array<const glm::vec3*, 2> known{beside(corner, 1, corner), beside(3 * t + (k + 2) % 3, 0, corner)};
    std::size_t apart = 0;
    for (std::size_t i = 0; i < 2; ++i) {
      if (!known[i] || (i == 1 && known[0] && *known[0] == *known[1])) continue;
      bool same = false;
      if constexpr (kWrites) same = glm::dot(*known[i], own_[corner]) >= together_;
      if (decisions_.bit(same_[i][apart][last_apart_], same)) {
        normals_[corner] = *known[i];
        last_apart_ = apart > 0 ? 1 : 0;
        return true;
      }
      ++apart;
    }
    last_apart_ = apart > 0 ? 1 : 0;
    return place(corner);
  }
  /// Codes the difference between a corner's normal and the normal by the shading rule. Mirrors the square so that the
  /// rule's normal is in the half around the middle.
  bool place(std::uint32_t corner) {
    const bool mirrored = shaded_[corner].z < 0;
    const auto turned = [&](glm::vec3 n) {
      if (mirrored) n.z = -n.z;
      return n;
    };
    glm::ivec2 at = square_.point_of(turned(shaded_[corner])), is(0);
    if constexpr (kWrites) is = square_.point_of(turned(own_[corner]));
    const displaced::Corners& of = mesh_.triangles[corner / 3];
    const std::uint32_t off_around = offs_[of[0]] + offs_[of[1]] + offs_[of[2]];
    const std::size_t rank = std::min<std::size_t>(grade(off_around) / 2, kRanks - 1);
    std::size_t before = 0;
    std::uint32_t sum = 0;
    for (int axis = 0; axis < 2; ++axis) {
      const int off = decisions_.number(sizes_[rank], sizes_before_[before], digits_, is[axis] - at[axis]);
      at[axis] = std::clamp(at[axis] + off, 0, square_.top());
      const auto size = static_cast<std::uint32_t>(std::abs(off));
      before = std::min<std::size_t>(static_cast<std::size_t>(std::bit_width(size)) + 1, kBefore - 1);
      sum += size;
    }
    offs_[of[corner % 3]] = std::min<std::uint32_t>(4 * sum, 4000);
    normals_[corner] = turned(square_.direction_of(at));
    return true;
  }

  static constexpr std::size_t kRanks = 16, kBefore = 16;
  Decisions<Coder> decisions_;
  const ExactMesh& mesh_;
  std::span<const glm::vec3> shaded_, own_;
  Square square_;
  float together_;
  std::vector<glm::vec3> normals_;
  std::vector<std::uint32_t> offs_;  // size of the last difference coded at each vertex
  std::size_t last_apart_ = 0;
  std::array<std::array<std::array<TwoRates, 2>, 2>, 2> same_;
  std::array<Lengths, kRanks> sizes_;
  std::array<Lengths, kBefore> sizes_before_;
  Digits digits_;
};

}  // namespace

std::vector<std::byte> encode_normals(const ExactMesh& mesh, std::span<const glm::vec3> shaded,
                                      std::span<const glm::vec3> own, int bits) {
  std::vector<std::byte> bytes;
  ByteWriter out(bytes);
  out.integer(static_cast<std::uint8_t>(bits));
  out.integer(static_cast<std::uint32_t>(mesh.triangles.size()));
  displaced::BinaryEncoder encoder;
  NormalCoder<displaced::BinaryEncoder> coder(encoder, mesh, shaded, own, bits);
  (void)coder.run();
  const std::vector<std::byte> body = encoder.finish();
  bytes.insert(bytes.end(), body.begin(), body.end());
  return bytes;
}

std::optional<std::vector<glm::vec3>> decode_normals(std::span<const std::byte> bytes, const ExactMesh& mesh,
                                                     std::span<const glm::vec3> shaded) {
  ByteReader in(bytes);
  const int bits = in.integer<std::uint8_t>();
  const std::size_t triangles = in.integer<std::uint32_t>();
  if (!in.good() || bits < kMinNormalBits || bits > kMaxNormalBits || triangles != mesh.triangles.size() ||
      shaded.size() != 3 * triangles || mesh.twins.size() != shaded.size())
    return {};
  displaced::BinaryDecoder decoder(bytes.subspan(kNormalsHeaderBytes));
  NormalCoder<displaced::BinaryDecoder> coder(decoder, mesh, shaded, {}, bits);
  if (!coder.run()) return {};
  return std::move(coder.normals());
}

std::vector<glm::vec3> shaded_normals(const ExactMesh& mesh, const Shading& shading) {
  std::vector<glm::vec3> faces;
  faces.reserve(mesh.triangles.size());
  for (const displaced::Corners& t : mesh.triangles) {
    const glm::vec3 a(mesh.vertices[t[0]]);
    faces.push_back(glm::cross(glm::vec3(mesh.vertices[t[1]]) - a, glm::vec3(mesh.vertices[t[2]]) - a));
  }
  return corner_normals({mesh.triangles, mesh.twins, faces, mesh.vertices.size()}, shading);
}

double distance_of(std::span<const glm::vec3> shaded, std::span<const glm::vec3> own) {
  double sum = 0;
  for (std::size_t c = 0; c < own.size(); ++c) sum += 2 - 2 * static_cast<double>(glm::dot(shaded[c], own[c]));
  return std::sqrt(std::max(sum, 0.0) / static_cast<double>(std::max<std::size_t>(own.size(), 1)));
}

}  // namespace gs::qnv::exact
