#include "qnv/codecs/outlines/grouping/outline_parts.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <utility>

namespace gs::qnv::outline {
namespace {

constexpr std::uint32_t kMoreThanTwo = 0xfffffffeu;

double distance2_to_segment(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b) {
  const glm::dvec3 along = b - a, from = p - a;
  const double length2 = glm::dot(along, along);
  const double t = length2 > 0 ? std::clamp(glm::dot(from, along) / length2, 0.0, 1.0) : 0;
  const glm::dvec3 away = from - along * t;
  return glm::dot(away, away);
}

class Simplifier {
 public:
  Simplifier(const Mesh& mesh, const std::vector<std::uint8_t>& boundary, double tolerance)
      : mesh_(mesh),
        tolerance2_(tolerance * tolerance),
        neighbours_(mesh.positions.size(), {kNone, kNone}),
        kept_(mesh.positions.size()) {
    for (std::uint32_t h = 0; h < mesh.vertices.size(); ++h) {
      if (!boundary[h]) continue;
      note(mesh.vertices[h], mesh.target(h));
      note(mesh.target(h), mesh.vertices[h]);
    }
  }

  std::vector<std::uint8_t> run() {
    for (std::uint32_t vertex = 0; vertex < neighbours_.size(); ++vertex)
      if (!inner(vertex)) kept_[vertex] = 1;
    std::vector<std::uint8_t> seen(kept_);
    std::vector<std::uint32_t> back;
    for (std::uint32_t vertex = 0; vertex < neighbours_.size(); ++vertex) {
      if (seen[vertex]) continue;
      chain_.assign(1, vertex);
      seen[vertex] = 1;
      follow(neighbours_[vertex][0], seen);
      if (chain_.size() > 2 && chain_.back() == vertex) {
        simplify_loop();
        continue;
      }
      back.assign(chain_.rbegin(), chain_.rend());
      chain_.swap(back);
      follow(neighbours_[vertex][1], seen);
      simplify(0, chain_.size() - 1);
    }
    return std::move(kept_);
  }

 private:
  void note(std::uint32_t vertex, std::uint32_t neighbour) {
    auto& [first, second] = neighbours_[vertex];
    if (first == neighbour || second == neighbour) return;
    if (first == kNone)
      first = neighbour;
    else
      second = second == kNone ? neighbour : kMoreThanTwo;
  }

  // Reports whether exactly two edges meet at a vertex.
  [[nodiscard]] bool inner(std::uint32_t vertex) const { return neighbours_[vertex][1] < kMoreThanTwo; }

  // Extends the chain to the next vertex that must stay or that the chain visited before.
  void follow(std::uint32_t to, std::vector<std::uint8_t>& seen) {
    std::uint32_t from = chain_.back();
    while (true) {
      chain_.push_back(to);
      if (seen[to]) return;
      seen[to] = 1;
      const auto& [first, second] = neighbours_[to];
      const std::uint32_t after = first == from ? second : first;
      from = std::exchange(to, after);
    }
  }

  [[nodiscard]] glm::dvec3 position(std::size_t i) const { return {mesh_.positions[chain_[i]]}; }

  // Simplifies a closed loop. The ends are the lowest vertex, which is a corner, and the vertex farthest from it.
  void simplify_loop() {
    chain_.pop_back();
    const auto before = [&](std::uint32_t a, std::uint32_t b) {
      const glm::vec3 &p = mesh_.positions[a], &q = mesh_.positions[b];
      return p.x != q.x ? p.x < q.x : p.y != q.y ? p.y < q.y : p.z < q.z;
    };
    std::rotate(chain_.begin(), std::min_element(chain_.begin(), chain_.end(), before), chain_.end());
    chain_.push_back(chain_.front());
    std::size_t farthest = 1;
    double most = -1;
    for (std::size_t i = 1; i + 1 < chain_.size(); ++i) {
      const glm::dvec3 away = position(i) - position(0);
      if (glm::dot(away, away) <= most) continue;
      most = glm::dot(away, away);
      farthest = i;
    }
    kept_[chain_[0]] = 1;
    kept_[chain_[farthest]] = 1;
    simplify(0, farthest);
    simplify(farthest, chain_.size() - 1);
  }

  // Keeps the vertex that is farthest from the line between two kept vertices; then repeats in both halves. After
  // several uneven splits, splits in the middle instead, which bounds the time.
  void simplify(std::size_t first, std::size_t last) {
    constexpr int kMaxDeep = 64;
    struct Part {
      std::size_t first, last;
      int deep;
    };
    std::vector<Part> parts{{first, last, 0}};
    while (!parts.empty()) {
      const Part part = parts.back();
      parts.pop_back();
      if (part.last - part.first < 2) continue;
      const glm::dvec3 a = position(part.first), b = position(part.last);
      double most = tolerance2_;
      std::size_t farthest = 0;
      for (std::size_t i = part.first + 1; i < part.last; ++i) {
        const double distance2 = distance2_to_segment(position(i), a, b);
        if (distance2 <= most) continue;
        most = distance2;
        farthest = i;
      }
      if (farthest == 0) continue;
      if (part.deep >= kMaxDeep) farthest = part.first + (part.last - part.first) / 2;
      kept_[chain_[farthest]] = 1;
      parts.push_back({part.first, farthest, part.deep + 1});
      parts.push_back({farthest, part.last, part.deep + 1});
    }
  }

  const Mesh& mesh_;
  double tolerance2_;
  std::vector<std::array<std::uint32_t, 2>> neighbours_;
  std::vector<std::uint8_t> kept_;
  std::vector<std::uint32_t> chain_;
};

}  // namespace

std::vector<std::uint8_t> kept_vertices(const Mesh& mesh, const std::vector<std::uint8_t>& boundary, double tolerance) {
  if (!(tolerance >= 0)) return std::vector<std::uint8_t>(mesh.positions.size(), 1);
  return Simplifier(mesh, boundary, tolerance).run();
}

}  // namespace gs::qnv::outline
