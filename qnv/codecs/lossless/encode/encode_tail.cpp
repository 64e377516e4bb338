#include "qnv/codecs/lossless/exact_header.h"
#include "qnv/codecs/lossless/exact_tail.h"
#include "qnv/codecs/lossless/mesh_growth.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <utility>

namespace gs::qnv::exact {
namespace {

using displaced::BinaryEncoder;
using displaced::Corners;
using displaced::kNone;

// Number of traversals that fit the weights. Each traversal uses the weights of the previous one. A last traversal
// writes the tail.
constexpr int kFits = 2;
// Weight of the default prediction weights in the fit, relative to the mean square of the measured data.
constexpr double kUsualWorth = 1e-3;

/// Least-squares fit of the prediction weights, over all new vertices of one situation.
class Fit {
 public:
  void add(std::size_t situation, const std::array<glm::ivec3, kNear>& near, const glm::ivec3& is, double spread) {
    Sums& sums = sums_[situation];
    const double worth = 1 / (spread * spread);
    for (std::size_t i = 0; i < kNear; ++i) {
      sums.right[i] += worth * static_cast<double>(dot(near[i], is));
      for (std::size_t j = 0; j <= i; ++j) sums.left[i][j] += worth * static_cast<double>(dot(near[i], near[j]));
    }
  }
  [[nodiscard]] Weights weights(const Weights& usual) const {
    Weights out{};
    for (std::size_t s = 0; s < kSituations; ++s) out[s] = solved(sums_[s], usual[s]);
    return out;
  }

 private:
  struct Sums {
    std::array<std::array<double, kNear>, kNear> left{};
    std::array<double, kNear> right{};
  };
  using Row = std::array<std::int16_t, kNear>;

  static Row solved(const Sums& sums, const Row& usual) {
    constexpr double kOne = 1 << kWeightBits;
    auto left = sums.left;
    auto right = sums.right;
    double trace = 0;
    for (std::size_t i = 0; i < kNear; ++i) trace += left[i][i];
    const double worth = trace / kNear * kUsualWorth + 1e-9;
    for (std::size_t i = 0; i < kNear; ++i) {
      left[i][i] += worth;
      right[i] += worth * usual[i] / kOne;
    }
    // Solves by Cholesky decomposition.
    for (std::size_t i = 0; i < kNear; ++i)
      for (std::size_t j = 0; j <= i; ++j) {
        double rest = left[i][j];
        for (std::size_t k = 0; k < j; ++k) rest -= left[i][k] * left[j][k];
        if (i == j) {
          if (!(rest > 0)) return usual;
          left[i][i] = std::sqrt(rest);
        } else {
          left[i][j] = rest / left[j][j];
        }
      }
    for (std::size_t i = 0; i < kNear; ++i) {
      for (std::size_t k = 0; k < i; ++k) right[i] -= left[i][k] * right[k];
      right[i] /= left[i][i];
    }
    for (std::size_t i = kNear; i-- > 0;) {
      for (std::size_t k = i + 1; k < kNear; ++k) right[i] -= left[k][i] * right[k];
      right[i] /= left[i][i];
    }
    Row out{};
    for (std::size_t i = 0; i < kNear; ++i)
      out[i] = static_cast<std::int16_t>(std::lround(std::clamp(right[i] * kOne, -32768.0, 32767.0)));
    return out;
  }

  std::array<Sums, kSituations> sums_;
};

/// Guide for MeshGrowth in an encoder. A half is a side of a triangle of the source mesh, three per triangle.
class MeshGuide {
 public:
  /// `starts` lists triangles in the order in which components may start. If empty, components start in the order of
  /// triangle indices.
  MeshGuide(const ExactMesh& mesh, const std::vector<std::uint32_t>& twins, const TailRanks* ranks,
            const std::vector<std::uint32_t>& starts, Fit& fit)
      : mesh_(mesh),
        twins_(twins),
        ranks_(ranks),
        starts_(starts),
        fit_(fit),
        numbers_(mesh.vertices.size(), kNone),
        sides_(mesh.triangles.size() * 3, kNone) {
    halves_.reserve(sides_.size());
  }
  std::uint32_t start() {
    const auto half = [&] { return 3 * (starts_.empty() ? next_ : starts_[next_]); };
    while (done(half())) ++next_;
    return half();
  }
  [[nodiscard]] std::uint32_t rank(std::size_t cell) const { return ranks_->of[cell]; }
  /// Makes a vertex of the triangle of `half` the next vertex: corner k, counted from the start of `half`.
  glm::ivec3 fresh(std::uint32_t half, std::size_t k) {
    now_ = corner(half, k);
    numbers_[now_] = count_++;
    return place();
  }
  [[nodiscard]] glm::ivec3 place() const { return mesh_.vertices[now_]; }
  [[nodiscard]] glm::ivec3 color() const { return luma_of(mesh_.colors[now_]); }
  /// Returns the texture coordinates of the triangle that was added at index t.
  [[nodiscard]] CornerCoordinates coordinates(std::uint32_t t) const {
    CornerCoordinates is;
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t half = halves_[3 * t + k];
      is[k] = mesh_.coordinates[half / 3][half % 3];
    }
    return is;
  }
  /// Returns the half that is the other side of the edge at `side`.
  [[nodiscard]] std::uint32_t beyond(std::uint32_t side) const { return twins_[halves_[side]]; }
  /// Returns the decoding index of the vertex opposite a half; kNone if that vertex is not coded yet.
  [[nodiscard]] std::uint32_t apex(std::uint32_t half) const { return numbers_[corner(half, 2)]; }
  /// Returns a half of the triangle that is adjacent to the triangle of `half`, at the side that ends where `half`
  /// starts. Returns kNone if that triangle is already coded or its third vertex is not `vertex`.
  [[nodiscard]] std::uint32_t beside_fresh(std::uint32_t half, std::uint32_t vertex) const {
    const std::uint32_t other = twins_[before(half)];
    return other != kNone && !done(other) && apex(other) == vertex ? other : kNone;
  }
  /// Returns a side that leaves the vertex opposite a half: the first one after the gap that contains the triangle of
  /// `half`.
  [[nodiscard]] std::uint32_t side_at_apex(std::uint32_t half, const Gates& gates) const {
    std::uint32_t leaves = twins_[after(half)];
    while (leaves != kNone && !done(leaves)) leaves = twins_[before(leaves)];
    if (leaves != kNone) return sides_[leaves];
    // The first direction reached a rim. Searches in the other direction.
    std::uint32_t enters = twins_[before(half)];
    while (enters != kNone && !done(enters)) enters = twins_[after(enters)];
    return enters == kNone ? kNone : gates.next(sides_[enters]);
  }
  void added(std::uint32_t half) {
    for (int k = 0; k < 3; ++k, half = after(half)) {
      sides_[half] = static_cast<std::uint32_t>(halves_.size());
      halves_.push_back(half);
    }
  }
  [[nodiscard]] TailOrder take_order() {
    TailOrder order{std::move(numbers_), {}};
    order.triangles.reserve(halves_.size() / 3);
    for (std::size_t side = 0; side < halves_.size(); side += 3) order.triangles.push_back(halves_[side] / 3);
    return order;
  }
  void learn(std::size_t situation, const std::array<glm::ivec3, kNear>& near, const glm::ivec3& is,
             std::uint32_t spread) {
    fit_.add(situation, near, is, spread);
  }

 private:
  static std::uint32_t after(std::uint32_t half) { return half % 3 == 2 ? half - 2 : half + 1; }
  static std::uint32_t before(std::uint32_t half) { return half % 3 == 0 ? half + 2 : half - 1; }
  [[nodiscard]] bool done(std::uint32_t half) const { return sides_[half] != kNone; }
  [[nodiscard]] std::uint32_t corner(std::uint32_t half, std::size_t k) const {
    return mesh_.triangles[half / 3][(half % 3 + k) % 3];
  }

  const ExactMesh& mesh_;
  const std::vector<std::uint32_t>& twins_;
  const TailRanks* ranks_;
  const std::vector<std::uint32_t>& starts_;
  Fit& fit_;
  std::vector<std::uint32_t> numbers_;  // decoding index of each vertex
  std::vector<std::uint32_t> halves_, sides_;  // half of each side; side of each half
  std::uint32_t next_ = 0, now_ = 0, count_ = 0;
};

// Returns the triangles in the order of growth: those in cells of low rank first.
std::vector<std::uint32_t> starts_of(const ExactMesh& mesh, const TailRanks& ranks) {
  std::vector<std::uint32_t> starts(mesh.triangles.size());
  std::iota(starts.begin(), starts.end(), 0u);
  const auto rank = [&](std::uint32_t t) {
    return ranks.of[cell_of(mesh.vertices[mesh.triangles[t][0]], mesh.bits, ranks.cell_bits)];
  };
  std::ranges::stable_sort(starts, {}, rank);
  return starts;
}

// Returns the crease angle, in degrees, that classifies the fewest edges wrongly as smooth or as creases.
int crease_angle_of(const displaced::SurfaceMesh& mesh) {
  constexpr float kApart = 0.9995f;  // minimum cosine between the normals at a smooth edge
  if (mesh.normals.empty()) return 180;
  const auto normal_of = [&](std::uint32_t t) {
    const Corners& c = mesh.triangles[t];
    const glm::vec3 a = mesh.positions[c[0]];
    const glm::vec3 n = glm::cross(mesh.positions[c[1]] - a, mesh.positions[c[2]] - a);
    const float length = glm::length(n);
    return length > 0 ? n / length : glm::vec3(0);
  };
  const auto shading = [&](std::uint32_t t, std::uint32_t vertex) {
    for (std::size_t k = 0; k < 2; ++k)
      if (mesh.triangles[t][k] == vertex) return mesh.normals[t][k];
    return mesh.normals[t][2];
  };
  std::array<std::int64_t, 181> apart{}, together{};  // number of crease edges and of smooth edges, by angle in degrees
  const auto beside = displaced::neighbours_of(mesh.triangles);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t other = beside[t][k];
      if (other == kNone || other < t) continue;
      const glm::vec3 n = normal_of(t), m = normal_of(other);
      if (n == glm::vec3(0) || m == glm::vec3(0)) continue;
      const double cosine = std::clamp(static_cast<double>(glm::dot(n, m)), -1.0, 1.0);
      const auto angle = static_cast<std::size_t>(std::ceil(std::acos(cosine) * 180 / std::numbers::pi - 1e-3));
      bool parted = false;
      for (const std::uint32_t v : {mesh.triangles[t][k], mesh.triangles[t][(k + 1) % 3]})
        parted = parted || glm::dot(shading(t, v), shading(other, v)) < kApart;
      ++(parted ? apart : together)[std::min<std::size_t>(angle, 180)];
    }
  // Tries each angle as the maximum of smooth edges.
  std::int64_t wrong = 0, least = 0;
  for (std::size_t angle = 181; angle-- > 0;) wrong += apart[angle];
  int best = 180;
  least = wrong;
  for (std::size_t angle = 180; angle-- > 0;) {
    wrong += together[angle + 1] - apart[angle + 1];
    if (wrong < least) {
      least = wrong;
      best = static_cast<int>(angle);
    }
  }
  return best;
}

}  // namespace

ExactMesh quantized(displaced::SurfaceMesh mesh, int bits) {
  const auto top = static_cast<float>((1 << bits) - 1);
  displaced::part(mesh);
  ExactMesh out;
  out.bits = bits;
  out.crease_angle = crease_angle_of(mesh);
  for (glm::vec3& p : mesh.positions) p = glm::clamp(glm::floor(p * top + 0.5f), 0.0f, top);
  // Uses quantised positions: for small flat-shaded triangles, the shading chunk costs more than it saves.
  out.shading = shading_of(mesh, out.crease_angle);
  out.vertices.reserve(mesh.positions.size());
  for (const glm::vec3& p : mesh.positions) out.vertices.emplace_back(p);
  out.colors = std::move(mesh.colors);
  out.normals = std::move(mesh.normals);
  out.triangles = std::move(mesh.triangles);
  return out;
}

std::vector<std::byte> encode_tail(const ExactMesh& mesh, bool usual, const TailRanks* ranks, TailOrder* order) {
  TailHeader header;
  header.bits = mesh.bits;
  header.finest = std::max(mesh.finest, mesh.bits);
  header.crease_angle = mesh.crease_angle;
  header.colored = !mesh.colors.empty();
  header.vertices = static_cast<std::uint32_t>(mesh.vertices.size());
  header.triangles = static_cast<std::uint32_t>(mesh.triangles.size());
  header.usual = usual;
  header.weights = kUsualWeights;
  header.cell_bits = ranks ? ranks->cell_bits : 0;
  if (!mesh.coordinates.empty()) header.texture = mesh.texture;
  const std::vector<std::uint32_t> starts = ranks ? starts_of(mesh, *ranks) : std::vector<std::uint32_t>();
  const std::vector<std::uint32_t> twins = twins_of(mesh.triangles);
  std::vector<std::byte> body;
  for (int pass = usual ? kFits : 0; pass <= kFits; ++pass) {
    BinaryEncoder encoder;
    Fit fit;
    MeshGuide guide(mesh, twins, ranks, starts, fit);
    MeshGrowth<BinaryEncoder, MeshGuide> growth(encoder, header, guide, mesh.triangles.size());
    if (!growth.run()) return {};
    if (pass < kFits)
      header.weights = fit.weights(kUsualWeights);
    else
      body = encoder.finish();
    if (order) *order = guide.take_order();
  }
  std::vector<std::byte> bytes = encode_tail_header(header);
  bytes.insert(bytes.end(), body.begin(), body.end());
  const std::size_t least = (mesh.triangles.size() + kMaxTrianglesAByte - 1) / kMaxTrianglesAByte;
  if (bytes.size() < least) bytes.resize(least);
  return bytes;
}

}  // namespace gs::qnv::exact
