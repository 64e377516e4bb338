#pragma once

#include "qnv/base/parallel.h"
#include "qnv/displaced/stage/bases_ahead.h"
#include "qnv/displaced/stage/target.h"
#include "qnv/displaced/surface.h"

#include <cstddef>
#include <vector>

namespace gs::qnv::displaced {

/// A cluster on its way into a stream.
struct StageCluster {
  ClusterHeader header;
  std::vector<std::byte> payload;  // with the header
  double gain = 0;                 // of slope: the squares of what vertices are moved by, units^2
  std::uint32_t vertices = 0;      // new ones
  Box box;
};

struct EncodedStage {
  StageHeader header;
  std::vector<std::byte> bytes;  // of the stage's header
  std::vector<StageCluster> clusters;
  /// How far places of the target are from what the whole stage becomes, or what of it there is, root of the mean
  /// square, units.
  float error = 0;
};

struct StageOptions {
  std::size_t triangles = 600;  // of the base, about
  std::size_t most_bytes = 0;   // of its header; 0: any
  int number = 0;
  int step_exponent = 10, layers = 2;
  bool colored = false;
  bool beside = false;  // StageHeader::beside; then the base is the whole mesh
  // Another stage follows where the error is larger; 0: none ever does. A stage of which that is clear beforehand is
  // made without its finest levels, unless its error is larger than can be trusted then.
  float most_error = 0, trusted_error = 0;
  BasesAhead* bases = nullptr;  // of `coarse`; null: bases are made when they are asked for
  unsigned threads = 0;
};

/// The base of the stage behind one has so many times as many triangles.
inline constexpr std::size_t kMoreTriangles = 4;

/// The payload of a cluster: its header, and the numbers that a surface has there.
[[nodiscard]] std::vector<std::byte> encode_cluster(Surface& surface, const ClusterHeader& header);

/// Makes a stage. `coarse`: a mesh close to the target, of which bases are made.
[[nodiscard]] EncodedStage encode_stage_of(const Target& target, const SurfaceMesh& coarse, const StageOptions& options,
                                           Progress* progress);

}  // namespace gs::qnv::displaced
