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
  double gain = 0;                 // sum of squared vertex displacements, units^2
  std::uint32_t vertices = 0;      // new vertices
  Box box;
};

struct EncodedStage {
  StageHeader header;
  std::vector<std::byte> bytes;  // of the stage's header
  std::vector<StageCluster> clusters;
  /// Root mean square distance between points of the target and the surface of the whole stage, or its available part.
  /// Units of the Frame.
  float error = 0;
};

struct StageOptions {
  std::size_t triangles = 600;  // of the base, approximate
  std::size_t most_bytes = 0;   // of the header; 0 means unlimited
  int number = 0;
  int step_exponent = 10, layers = 2;
  bool colored = false;
  bool beside = false;  // StageHeader::beside; the base is then the whole mesh
  // A larger error than `most_error` requires another stage; 0: never. A stage that clearly needs a next one is encoded
  // without its finest levels, unless its error then exceeds `trusted_error`.
  float most_error = 0, trusted_error = 0;
  BaseMeshPrefetcher* bases = nullptr;  // bases of `coarse`; if nullptr, bases are made on request
  unsigned threads = 0;
};

/// Ratio of the triangle counts of a stage's base and the previous one's.
inline constexpr std::size_t kMoreTriangles = 4;

/// Returns the payload of a cluster: its header, and the surface's numbers.
[[nodiscard]] std::vector<std::byte> encode_cluster(Surface& surface, const ClusterHeader& header);

/// Encodes a stage. Bases are simplified from `coarse`, a mesh close to the target.
[[nodiscard]] EncodedStage encode_stage_of(const Target& target, const SurfaceMesh& coarse, const StageOptions& options,
                                           Progress* progress);

}  // namespace gs::qnv::displaced
