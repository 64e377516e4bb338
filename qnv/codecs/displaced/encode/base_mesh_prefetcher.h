#pragma once

#include "qnv/mesh/manifold.h"

#include <cstddef>
#include <future>

namespace gs::qnv::displaced {

/// Simplifies one mesh to several sizes, and computes the next size while the caller uses the previous one. Collapses
/// are single-threaded, so other cores would idle until a base is ready.
class BaseMeshPrefetcher {
 public:
  /// `mesh` must outlive this object. `threads` is as in parallel_for().
  BaseMeshPrefetcher(const SurfaceMesh& mesh, unsigned threads);

  /// Announces the probable size of the next request.
  void expect(std::size_t triangles);
  /// Returns the result of simplify().
  [[nodiscard]] SurfaceMesh base(std::size_t triangles);

 private:
  const SurfaceMesh& mesh_;
  bool alone_;
  std::size_t expected_ = 0;
  std::future<SurfaceMesh> coming_;
};

}  // namespace gs::qnv::displaced
