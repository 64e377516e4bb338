#include "qnv/codecs/lossless/shading.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

namespace gs::qnv::exact {
namespace {

using displaced::Corners;
using displaced::kNone;

constexpr std::size_t kShadingBytes = 2;
// Maximum number of corners at a vertex for which all pairs of faces are compared.
constexpr std::uint32_t kMaxPairs = 256;
// Approximate number of vertices that an encoder tests.
constexpr std::size_t kLookedAt = 6000;

float cosine_of(int degrees) { return static_cast<float>(std::cos((degrees + 0.01) * std::numbers::pi / 180)); }

glm::vec3 unit_or_up(const glm::vec3& v) {
  const float length = glm::length(v);
  return length > 0 ? v / length : glm::vec3(0, 0, 1);
}

/// Sets of corners that are connected across edges with at most a given angle between both faces.
class JoinedCorners {
 public:
  JoinedCorners(const ShadedMesh& mesh, int angle) : sets_(3 * mesh.triangles.size()) {
    std::iota(sets_.begin(), sets_.end(), 0u);
    const auto next = [](std::uint32_t side) { return side % 3 == 2 ? side - 2 : side + 1; };
    const float cosine = cosine_of(angle);
    for (std::uint32_t side = 0; side < sets_.size(); ++side) {
      const std::uint32_t twin = mesh.twins[side];
      if (twin == kNone || twin < side) continue;
      // A face without area has no direction. Its edges are not creases.
      const glm::vec3 &n = mesh.faces[side / 3], &m = mesh.faces[twin / 3];
      const float lengths = glm::length(n) * glm::length(m);
      if (angle < 180 && lengths > 0 && glm::dot(n, m) < cosine * lengths) continue;
      sets_[find(side)] = find(next(twin));
      sets_[find(next(side))] = find(twin);
    }
  }
  std::uint32_t find(std::uint32_t i) {
    while (sets_[i] != i) i = sets_[i] = sets_[sets_[i]];
    return i;
  }

 private:
  std::vector<std::uint32_t> sets_;
};

std::vector<glm::vec3> by_edges(const ShadedMesh& mesh, int angle) {
  JoinedCorners joined(mesh, angle);
  std::vector<glm::vec3> normals(3 * mesh.triangles.size(), glm::vec3(0));
  for (std::uint32_t c = 0; c < normals.size(); ++c) normals[joined.find(c)] += mesh.faces[c / 3];
  for (glm::vec3& n : normals) n = unit_or_up(n);
  for (std::uint32_t c = 0; c < normals.size(); ++c) normals[c] = normals[joined.find(c)];
  return normals;
}

std::vector<glm::vec3> by_faces(const ShadedMesh& mesh, int angle, const std::vector<bool>& wanted) {
  const std::size_t corners = 3 * mesh.triangles.size();
  std::vector<glm::vec3> normals(corners, glm::vec3(0)), units(mesh.faces.size());
  for (std::size_t t = 0; t < units.size(); ++t) {
    const float length = glm::length(mesh.faces[t]);
    units[t] = length > 0 ? mesh.faces[t] / length : glm::vec3(0);
  }
  std::vector<std::uint32_t> ends(mesh.vertices + 1, 0), round(corners);
  for (const Corners& t : mesh.triangles)
    for (const std::uint32_t v : t) ++ends[v + 1];
  for (std::size_t v = 0; v < mesh.vertices; ++v) ends[v + 1] += ends[v];
  std::vector<std::uint32_t> next(ends.begin(), ends.end() - 1);
  for (std::uint32_t c = 0; c < corners; ++c) round[next[mesh.triangles[c / 3][c % 3]]++] = c;
  const float cosine = angle < 180 ? cosine_of(angle) : -2.0f;
  for (std::size_t v = 0; v < mesh.vertices; ++v) {
    if (!wanted.empty() && !wanted[v]) continue;
    const std::span<const std::uint32_t> around =
        std::span<const std::uint32_t>(round).subspan(ends[v], ends[v + 1] - ends[v]);
    const bool all = around.size() > kMaxPairs;
    glm::vec3 sum(0);
    if (all)
      for (const std::uint32_t c : around) sum += mesh.faces[c / 3];
    for (const std::uint32_t c : around) {
      const glm::vec3 own = units[c / 3];
      if (!all) {
        sum = glm::vec3(0);
        for (const std::uint32_t other : around)
          if (other == c || own == glm::vec3(0) || glm::dot(own, units[other / 3]) >= cosine)
            sum += mesh.faces[other / 3];
      }
      normals[c] = unit_or_up(sum);
    }
  }
  return normals;
}

}  // namespace

std::vector<std::uint32_t> twins_of(std::span<const Corners> triangles) {
  const auto beside = displaced::neighbours_of(triangles);
  std::vector<std::uint32_t> twins(triangles.size() * 3, kNone);
  for (std::uint32_t t = 0; t < triangles.size(); ++t)
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t other = beside[t][k];
      if (other == kNone) continue;
      for (std::uint32_t l = 0; l < 3; ++l)
        if (triangles[other][l] == triangles[t][(k + 1) % 3] && triangles[other][(l + 1) % 3] == triangles[t][k])
          twins[3 * t + k] = 3 * other + l;
    }
  return twins;
}

std::vector<std::byte> encode_shading(const Shading& shading) {
  return {static_cast<std::byte>(shading.rule), static_cast<std::byte>(shading.angle)};
}

std::optional<Shading> decode_shading(std::span<const std::byte> payload) {
  if (payload.size() != kShadingBytes) return {};
  const int rule = std::to_integer<int>(payload[0]), angle = std::to_integer<int>(payload[1]);
  if (rule != static_cast<int>(Shading::Rule::faces) || angle > 180) return {};
  return Shading{Shading::Rule::faces, angle};
}

std::vector<glm::vec3> corner_normals(const ShadedMesh& mesh, const Shading& shading, const std::vector<bool>& wanted) {
  return shading.rule == Shading::Rule::edges ? by_edges(mesh, shading.angle) : by_faces(mesh, shading.angle, wanted);
}

Shading shading_of(const displaced::SurfaceMesh& mesh, int edges_angle) {
  Shading best{Shading::Rule::edges, edges_angle};
  if (mesh.normals.empty() || edges_angle >= 180) return best;
  // Tests a sample of the vertices, with all triangles around them.
  const std::size_t one_in = mesh.positions.size() / kLookedAt + 1;
  std::vector<bool> wanted(mesh.positions.size(), false);
  for (std::size_t v = 0; v < wanted.size(); v += one_in) wanted[v] = true;
  std::vector<Corners> triangles;
  std::vector<glm::vec3> faces;
  std::vector<std::array<glm::vec3, 3>> given;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Corners& c = mesh.triangles[t];
    if (!wanted[c[0]] && !wanted[c[1]] && !wanted[c[2]]) continue;
    const glm::vec3 a = mesh.positions[c[0]];
    triangles.push_back(c);
    faces.push_back(glm::cross(mesh.positions[c[1]] - a, mesh.positions[c[2]] - a));
    given.push_back(mesh.normals[t]);
  }
  const std::vector<std::uint32_t> twins = twins_of(triangles);
  const ShadedMesh shaded{triangles, twins, faces, mesh.positions.size()};
  const auto off = [&](const Shading& shading) {
    const std::vector<glm::vec3> normals = corner_normals(shaded, shading, wanted);
    double sum = 0;
    for (std::size_t c = 0; c < normals.size(); ++c) {
      const glm::vec3& is = given[c / 3][c % 3];
      if (wanted[triangles[c / 3][c % 3]] && is != glm::vec3(0))
        sum += 1.0 - static_cast<double>(glm::dot(normals[c], is));
    }
    return sum;
  };
  double least = off(best);
  const auto look = [&](int angle) {
    const Shading shading{Shading::Rule::faces, angle};
    if (const double error = off(shading); error < 0.99 * least) {
      least = error;
      best = shading;
    }
  };
  // Tries coarse steps of the angle first, then refines around the best one.
  for (int angle = 0; angle <= 180; angle += angle < 100 ? 10 : 20) look(angle);
  if (best.rule == Shading::Rule::faces)
    for (int step = 8; step > 0; step /= 2) {
      const int middle = best.angle;
      for (const int angle : {middle - step, middle + step})
        if (angle >= 0 && angle <= 180) look(angle);
    }
  return best;
}

}  // namespace gs::qnv::exact
