#pragma once

#include "qnv/codecs/lossless/exact_mesh.h"

#include <cstddef>
#include <memory>
#include <span>

namespace gs::qnv::exact {

/// Incremental decoder of a tail: a mesh that grows triangle by triangle. At any time it is a part of the whole mesh.
/// Not thread-safe. Safe for untrusted bytes: memory and time are proportional to the bytes received.
class TailReader {
 public:
  enum class State {
    growing,  // needs more bytes
    whole,
    refused,  // the bytes are not a tail; the mesh decoded so far remains
    full      // has more vertices than allowed
  };

  /// `length` is that of the whole tail, in bytes.
  TailReader(std::size_t length, std::size_t most_vertices);
  TailReader(TailReader&&) noexcept;
  TailReader& operator=(TailReader&&) noexcept;
  ~TailReader();
  /// Decodes the next bytes. Ignores bytes past the end.
  void push(std::span<const std::byte> bytes);
  [[nodiscard]] State state() const { return state_; }
  /// Returns the triangles decoded; all_triangles() returns the total, or 0 if unknown.
  [[nodiscard]] std::size_t triangles() const;
  [[nodiscard]] std::size_t all_triangles() const;
  /// Reports whether corners have texture coordinates; false while unknown.
  [[nodiscard]] bool textured() const;
  /// Returns the mesh decoded so far.
  [[nodiscard]] ExactMesh mesh() const;

 private:
  struct Growing;
  std::size_t length_, most_vertices_;
  State state_ = State::growing;
  std::unique_ptr<Growing> growing_;
};

}  // namespace gs::qnv::exact
