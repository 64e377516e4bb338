#pragma once

#include "qnv/exact/exact_mesh.h"

#include <cstddef>
#include <memory>
#include <span>

namespace gs::qnv::exact {

/// A tail as its bytes come: a mesh that grows triangle by triangle. What is there at any time is a part of the whole,
/// as many triangles of it as the bytes say. One thread; safe for untrusted bytes: memory and time are in proportion to
/// what came.
class TailReader {
 public:
  enum class State {
    growing,  // more bytes are needed
    whole,
    refused,  // the bytes are no tail; what grew before that is still there
    full      // it has more vertices than there may be
  };

  /// `length`: of the whole tail, bytes.
  TailReader(std::size_t length, std::size_t most_vertices);
  TailReader(TailReader&&) noexcept;
  TailReader& operator=(TailReader&&) noexcept;
  ~TailReader();
  /// The next bytes. Those behind the end are passed over.
  void push(std::span<const std::byte> bytes);
  [[nodiscard]] State state() const { return state_; }
  /// How many triangles have come, and how many there will be; 0: that is not known yet.
  [[nodiscard]] std::size_t triangles() const;
  [[nodiscard]] std::size_t all_triangles() const;
  /// Whether corners have texture coordinates, as far as that is known.
  [[nodiscard]] bool textured() const;
  /// What has come.
  [[nodiscard]] ExactMesh mesh() const;

 private:
  struct Growing;
  std::size_t length_, most_vertices_;
  State state_ = State::growing;
  std::unique_ptr<Growing> growing_;
};

}  // namespace gs::qnv::exact
