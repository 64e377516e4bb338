#pragma once

#include "qnv/displaced/manifold.h"

#include <cstddef>
#include <future>

namespace gs::qnv::displaced {

/// Simplifies one mesh to several sizes, the next one while the one before it is worked on: collapses run on one
/// thread, and others have nothing to do until there is a base.
class BasesAhead {
 public:
  /// The mesh must stay. `threads`: as of parallel_for.
  BasesAhead(const SurfaceMesh& mesh, unsigned threads);

  /// So many triangles will probably be asked for next.
  void expect(std::size_t triangles);
  /// What simplify gives.
  [[nodiscard]] SurfaceMesh base(std::size_t triangles);

 private:
  const SurfaceMesh& mesh_;
  bool alone_;
  std::size_t expected_ = 0;
  std::future<SurfaceMesh> coming_;
};

}  // namespace gs::qnv::displaced
