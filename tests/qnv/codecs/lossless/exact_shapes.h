#pragma once

#include "qnv/codecs/displaced/surface.h"
#include "qnv/codecs/lossless/exact_tail.h"
#include "tests/qnv/codecs/displaced/displaced_shapes.h"

#include <glm/common.hpp>

#include <algorithm>
#include <array>
#include <random>
#include <string>
#include <utility>
#include <vector>

// Meshes for tests of exact tails, and their comparison.
namespace gs::qnv::exact {

/// Triangle as its corners, from the smallest on, in its orientation.
using Turned = std::array<std::array<int, 6>, 3>;  // position, colour

inline Turned turned(Turned t) {
  Turned least = t;
  for (int k = 0; k < 2; ++k) {
    std::rotate(t.begin(), t.begin() + 1, t.end());
    least = std::min(least, t);
  }
  return least;
}

/// Returns all triangles of a mesh, including duplicates.
inline std::vector<Turned> triangles_in(const ExactMesh& mesh) {
  std::vector<Turned> all;
  for (const displaced::Corners& t : mesh.triangles) {
    Turned corners{};
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::ivec3 p = mesh.vertices.at(t[k]);
      const Rgb8 c = mesh.colors.empty() ? Rgb8{} : mesh.colors.at(t[k]);
      corners[k] = {p.x, p.y, p.z, c.r, c.g, c.b};
    }
    all.push_back(turned(corners));
  }
  std::sort(all.begin(), all.end());
  return all;
}

/// Returns all triangles of a source, with each corner on the lattice. `rgb` adds the corners' colours.
inline std::vector<Turned> triangles_in(const Triangles& source, int bits, bool rgb) {
  const displaced::Frame frame(box_of(source));
  const auto top = static_cast<float>((1 << bits) - 1);
  std::vector<Turned> all;
  for (const Triangle& t : source) {
    if (t.positions[0] == t.positions[1] || t.positions[1] == t.positions[2] || t.positions[2] == t.positions[0])
      continue;
    Turned corners{};
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::vec3 p = glm::floor(frame.inside(t.positions[k]) * top + 0.5f);
      const Rgb8 c = rgb ? t.colors[k] : Rgb8{};
      corners[k] = {static_cast<int>(p.x), static_cast<int>(p.y), static_cast<int>(p.z), c.r, c.g, c.b};
    }
    all.push_back(turned(corners));
  }
  std::sort(all.begin(), all.end());
  return all;
}

/// Prepares a source as the encoder does.
inline ExactMesh mesh_of(const Triangles& source, int bits, bool colored) {
  displaced::MeshBuilder builder(colored);
  builder.add(source);
  displaced::SurfaceMesh mesh = builder.welded();
  const displaced::Frame frame(box_of(source));
  for (glm::vec3& p : mesh.positions) p = frame.inside(p);
  return quantized(std::move(mesh), bits);
}

struct Source {
  std::string name;
  Triangles triangles;
  bool colored = false;
};

/// Returns defective surfaces. The codec must restore each of them.
inline std::vector<Source> nasty_sources() {
  std::vector<Source> all;
  const glm::vec3 o(0), x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  all.push_back({"one triangle", {triangle_of(o, x, y)}});
  all.push_back({"the same triangle four times, once turned over",
                 {triangle_of(o, x, y), triangle_of(x, y, o), triangle_of(o, x, y), triangle_of(o, y, x)}});
  all.push_back({"five triangles at an edge",
                 {triangle_of(o, x, y), triangle_of(x, o, z), triangle_of(o, x, -y), triangle_of(x, o, -z),
                  triangle_of(o, x, y + z)}});
  all.push_back({"two that meet at a point, and one without an area",
                 {triangle_of(o, x, y), triangle_of(o, -x, -y), triangle_of(o, x, 2.0f * x), triangle_of(o, o, z)}});
  Triangles band;  // a Moebius strip
  for (int i = 0; i < 24; ++i) {
    const auto at = [](int k, float side) {
      const double a = 2 * std::numbers::pi * k / 24, b = a / 2;
      const double w = static_cast<double>(k >= 24 ? -side : side) * 0.3;
      const double b0 = k >= 24 ? 0 : b, a0 = k >= 24 ? 0 : a;
      return glm::vec3((1 + w * std::cos(b0)) * std::cos(a0), (1 + w * std::cos(b0)) * std::sin(a0), w * std::sin(b0));
    };
    band.push_back(triangle_of(at(i, -1), at(i + 1, -1), at(i + 1, 1)));
    band.push_back(triangle_of(at(i, -1), at(i + 1, 1), at(i, 1)));
  }
  all.push_back({"a band with one side", band});
  Triangles joined = displaced::ball(4);
  for (const Triangle& t : displaced::ball(4)) joined.push_back(t);
  all.push_back({"a ball twice", joined});
  Triangles heap = displaced::ball(6);
  for (Triangle& t : heap)
    for (glm::vec3& p : t.positions) p *= 1e-3f;
  for (const Triangle& t : displaced::ball(3)) heap.push_back(t);
  all.push_back({"a ball smaller than a step of the lattice in another", heap});
  std::mt19937 random(3);
  Triangles soup;
  std::vector<glm::vec3> few;
  for (int i = 0; i < 20; ++i)
    few.emplace_back(static_cast<float>(random() % 100), static_cast<float>(random() % 100),
                     static_cast<float>(random() % 100));
  for (int i = 0; i < 400; ++i) soup.push_back(triangle_of(few[random() % 20], few[random() % 20], few[random() % 20]));
  all.push_back({"random triangles between twenty places", soup});
  Triangles holes = displaced::torus(40, 20);
  for (std::size_t i = 0; i < holes.size(); ++i) std::swap(holes[i], holes[random() % holes.size()]);
  holes.resize(holes.size() * 2 / 3);
  all.push_back({"a torus of which a third is missing", holes});
  Triangles turned_over = displaced::ball(8);
  for (Triangle& t : turned_over)
    if (random() % 5 == 0) std::swap(t.positions[0], t.positions[1]);
  all.push_back({"a ball with triangles turned over", turned_over});
  Triangles flat;
  for (int i = 0; i < 30; ++i)
    for (int j = 0; j < 30; ++j) {
      const auto at = [](int u, int v) { return glm::vec3(u, v, 0); };
      flat.push_back(triangle_of(at(i, j), at(i + 1, j), at(i + 1, j + 1)));
      flat.push_back(triangle_of(at(i, j), at(i + 1, j + 1), at(i, j + 1)));
    }
  all.push_back({"a plane", flat});
  return all;
}

inline std::vector<Source> smooth_sources() {
  const auto painted = [](const glm::vec3& p) {
    const auto part = [](float v) { return static_cast<std::uint8_t>(127.5f + 127.5f * v); };
    return Rgb8{part(std::sin(3 * p.x)), part(std::cos(2 * p.y + 1)), part(p.z)};
  };
  return {{"ball", displaced::ball(8)},
          {"torus", displaced::torus(30, 16)},
          {"sheet with a hole", displaced::sheet(26)},
          {"painted ball", displaced::ball(9, painted), true}};
}

}  // namespace gs::qnv::exact
