#pragma once

#include "qnv/mesh/manifold.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace gs::qnv::displaced {

/// Triangles with a linked list of the corners at each vertex. Removed triangles leave the lists in gather(). Corner
/// 3 t + k is corner k of triangle t.
class LinkedTriangles {
 public:
  explicit LinkedTriangles(const SurfaceMesh& mesh)
      : triangles_(mesh.triangles),
        head_(mesh.positions.size(), kNone),
        tail_(mesh.positions.size(), kNone),
        next_(mesh.triangles.size() * 3, kNone),
        count_(mesh.triangles.size()) {
    for (std::uint32_t t = 0; t < triangles_.size(); ++t)
      for (std::uint32_t k = 0; k < 3; ++k) append_corner(triangles_[t][k], 3 * t + k);
  }

  /// Returns the number of triangles that are alive.
  [[nodiscard]] std::size_t count() const { return count_; }
  [[nodiscard]] const std::vector<Corners>& triangles() const { return triangles_; }
  [[nodiscard]] const Corners& of(std::uint32_t corner) const { return triangles_[corner / 3]; }
  [[nodiscard]] bool alive(std::uint32_t triangle) const { return triangles_[triangle][0] != kNone; }
  [[nodiscard]] std::uint32_t vertices() const { return static_cast<std::uint32_t>(head_.size()); }
  [[nodiscard]] bool used(std::uint32_t v) const { return head_[v] != kNone; }
  /// Calls `visit` for the corners at a vertex until it returns true. Returns whether it did.
  template <class Visit>
  bool any_corner(std::uint32_t v, const Visit& visit) const {
    for (std::uint32_t corner = head_[v]; corner != kNone; corner = next_[corner])
      if (alive(corner / 3) && visit(corner)) return true;
    return false;
  }
  /// Returns the triangle with the side from `a` to `b`, or kNone.
  [[nodiscard]] std::uint32_t left_of(std::uint32_t a, std::uint32_t b) const {
    for (std::uint32_t corner = head_[a]; corner != kNone; corner = next_[corner])
      if (alive(corner / 3) && triangles_[corner / 3][(corner % 3 + 1) % 3] == b) return corner / 3;
    return kNone;
  }
  [[nodiscard]] std::uint32_t third(std::uint32_t triangle, std::uint32_t a, std::uint32_t b) const {
    for (const std::uint32_t v : triangles_[triangle])
      if (v != a && v != b) return v;
    return kNone;
  }

  /// Fills `corners` with the corners at a vertex, and unlinks those of removed triangles.
  void gather(std::uint32_t v, std::vector<std::uint32_t>& corners) {
    corners.clear();
    std::uint32_t last = kNone;
    for (std::uint32_t corner = head_[v]; corner != kNone; corner = next_[corner]) {
      if (!alive(corner / 3)) continue;
      (last == kNone ? head_[v] : next_[last]) = corner;
      last = corner;
      corners.push_back(corner);
    }
    (last == kNone ? head_[v] : next_[last]) = kNone;
    tail_[v] = last;
  }
  void add_triangle(const Corners& triangle) {
    const auto t = static_cast<std::uint32_t>(triangles_.size());
    triangles_.push_back(triangle);
    next_.resize(next_.size() + 3, kNone);
    for (std::uint32_t k = 0; k < 3; ++k) append_corner(triangle[k], 3 * t + k);
    ++count_;
  }
  /// Moves the corners `all` of a vertex: those for which `moves` holds to a new vertex. Returns the new vertex.
  template <class Moves>
  std::uint32_t split(std::uint32_t v, const std::vector<std::uint32_t>& all, const Moves& moves) {
    const std::uint32_t copy = vertices();
    head_.push_back(kNone);
    tail_.push_back(kNone);
    head_[v] = tail_[v] = kNone;
    for (const std::uint32_t corner : all) {
      const std::uint32_t to = moves(corner) ? copy : v;
      triangles_[corner / 3][corner % 3] = to;
      next_[corner] = kNone;
      append_corner(to, corner);
    }
    return copy;
  }
  /// Moves the corners `at_u` of `u` to `v`, and removes the triangles at both.
  void merge(std::uint32_t u, std::uint32_t v, const std::vector<std::uint32_t>& at_u) {
    for (const std::uint32_t corner : at_u) {
      Corners& t = triangles_[corner / 3];
      if (t[0] == v || t[1] == v || t[2] == v) {
        t[0] = kNone;
        --count_;
      } else {
        t[corner % 3] = v;
      }
    }
    if (head_[u] == kNone) return;
    (head_[v] == kNone ? head_[v] : next_[tail_[v]]) = head_[u];
    tail_[v] = tail_[u];
    head_[u] = tail_[u] = kNone;
  }

 private:
  void append_corner(std::uint32_t v, std::uint32_t corner) {
    (head_[v] == kNone ? head_[v] : next_[tail_[v]]) = corner;
    tail_[v] = corner;
  }

  std::vector<Corners> triangles_;
  std::vector<std::uint32_t> head_, tail_, next_;
  std::size_t count_;
};

}  // namespace gs::qnv::displaced
