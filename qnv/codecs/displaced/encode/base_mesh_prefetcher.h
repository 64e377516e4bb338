#pragma once

#include "qnv/mesh/manifold.h"

#include <cstddef>
#include <future>

namespace gs::qnv::displaced {

/// Simplifier of one mesh to several sizes. It computes the next size on another thread while the caller uses the
/// previous result. Simplification is single-threaded, so other cores would otherwise wait for a base mesh.
class BaseMeshPrefetcher {
 public:
  /// `mesh` must outlive this object. If `threads` is 0, uses one thread per core.
  BaseMeshPrefetcher(const SurfaceMesh& mesh, unsigned threads);

  /// Starts to compute the mesh of the size that the caller will probably request next.
  void expect(std::size_t triangles);
  /// Returns the mesh, simplified to `triangles` triangles by simplify().
  [[nodiscard]] SurfaceMesh base(std::size_t triangles);

 private:
  const SurfaceMesh& mesh_;
  bool alone_;
  std::size_t expected_ = 0;
  std::future<SurfaceMesh> coming_;
};

}  // namespace gs::qnv::displaced
