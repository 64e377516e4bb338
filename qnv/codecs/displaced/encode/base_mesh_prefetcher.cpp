#include "qnv/codecs/displaced/encode/base_mesh_prefetcher.h"

#include "qnv/mesh/simplify/simplify.h"

#include <system_error>
#include <thread>

namespace gs::qnv::displaced {

BaseMeshPrefetcher::BaseMeshPrefetcher(const SurfaceMesh& mesh, unsigned threads)
    : mesh_(mesh), alone_(threads == 1 || (threads == 0 && std::thread::hardware_concurrency() <= 1)) {}

void BaseMeshPrefetcher::expect(std::size_t triangles) {
  if (alone_ || coming_.valid()) return;
  try {
    coming_ = std::async(std::launch::async, [this, triangles] { return simplify(mesh_, triangles); });
    expected_ = triangles;
  } catch (const std::system_error&) {
    // If the system allows no further thread, base() computes the mesh on request.
  }
}

SurfaceMesh BaseMeshPrefetcher::base(std::size_t triangles) {
  if (!coming_.valid()) return simplify(mesh_, triangles);
  SurfaceMesh came = coming_.get();
  return triangles == expected_ ? came : simplify(mesh_, triangles);
}

}  // namespace gs::qnv::displaced
