#pragma once

#include "base/parallel.h"
#include "qnv/codecs/displaced/encode/base_mesh_prefetcher.h"
#include "qnv/codecs/displaced/encode/target.h"
#include "qnv/codecs/displaced/surface.h"

#include <cstddef>
#include <vector>

namespace gs::qnv::displaced {

/// Cluster to be written to a stream.
struct StageCluster {
  ClusterHeader header;
  std::vector<std::byte> payload;  // including the header
  double gain = 0;  // reduction of the sum of squared vertex distances, units^2
  std::uint32_t vertices = 0;  // number of new vertices
  Box box;
};

struct EncodedStage {
  StageHeader header;
  std::vector<std::byte> bytes;  // encoded StageHeader with the base mesh
  std::vector<StageCluster> clusters;
  /// Root mean square distance between points of the target and the stage's surface, with all clusters that the stage
  /// has. Units of the Frame.
  float error = 0;
};

struct StageOptions {
  std::size_t triangles = 600;  // approximate number of triangles of the base mesh
  std::size_t most_bytes = 0;  // maximum bytes of the stage's header; 0 means unlimited
  int number = 0;
  int step_exponent = 10, layers = 2;
  bool colored = false;
  bool beside = false;  // value of StageHeader::beside; if set, the base is the whole mesh
  // A stage with an error above `most_error` needs a successor; 0 means never. A stage that clearly needs a successor
  // is encoded without its finest levels, unless its error would then exceed `trusted_error`.
  float most_error = 0, trusted_error = 0;
  BaseMeshPrefetcher* bases = nullptr;  // source of simplified meshes; if nullptr, encode_stage_of() simplifies
  unsigned threads = 0;
};

/// Number of triangles of a stage's base mesh, relative to the previous stage's base mesh.
inline constexpr std::size_t kMoreTriangles = 4;

/// Returns the payload of a cluster: its header and the numbers of the surface.
[[nodiscard]] std::vector<std::byte> encode_cluster(Surface& surface, const ClusterHeader& header);

/// Encodes a stage. Simplifies its base mesh from `coarse`, a mesh close to the target.
[[nodiscard]] EncodedStage encode_stage_of(const Target& target, const SurfaceMesh& coarse, const StageOptions& options,
                                           Progress* progress);

}  // namespace gs::qnv::displaced
