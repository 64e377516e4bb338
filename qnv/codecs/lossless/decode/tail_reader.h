#pragma once

#include "qnv/codecs/lossless/exact_mesh.h"

#include <cstddef>
#include <memory>
#include <span>

namespace gs::qnv::exact {

/// Incremental decoder of a tail: a mesh that grows triangle by triangle. At any time, the result is a part of the
/// whole mesh. One thread at a time. Safe for untrusted bytes: memory and time are proportional to the number of
/// received bytes.
class TailReader {
 public:
  enum class State {
    growing,  // needs more bytes
    whole,
    refused,  // the bytes are not a tail; triangles decoded before the error remain
    full  // the mesh has more vertices than allowed
  };

  /// `length` is the length of the whole tail, in bytes.
  TailReader(std::size_t length, std::size_t most_vertices);
  TailReader(TailReader&&) noexcept;
  TailReader& operator=(TailReader&&) noexcept;
  ~TailReader();
  /// Decodes the next bytes. Ignores bytes past the end.
  void push(std::span<const std::byte> bytes);
  [[nodiscard]] State state() const { return state_; }
  /// Returns the number of triangles decoded so far. all_triangles() returns the total, or 0 until the header is
  /// received.
  [[nodiscard]] std::size_t triangles() const;
  [[nodiscard]] std::size_t all_triangles() const;
  /// Reports whether corners have texture coordinates. Returns false until the header is received.
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
