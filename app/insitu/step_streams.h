#pragma once

#include "app/insitu/arrays/grid_parts.h"
#include "app/insitu/arrays/particle_parts.h"
#include "app/insitu/arrays/surface_parts.h"
#include "app/insitu/bricks/brick_shelf.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <variant>
#include <vector>

namespace gs::app::insitu {

/// Complete data of a step on rank 0.
struct StepData {
  std::int64_t step = 0;
  double time = 0;
  std::vector<GridValues> grids;
  std::vector<SurfaceValues> surfaces;
  std::vector<ParticleValues> particles;
  std::shared_ptr<ServedGrid> served;  // grid that the ranks keep for requests; null if there is none

  /// Returns the number of bytes of all copied data.
  [[nodiscard]] std::uint64_t bytes() const;
  /// Returns the number of bytes of the values of all grids, copied or not.
  [[nodiscard]] std::uint64_t grid_bytes() const;
};

/// Limits of the encoders.
struct StreamLimits {
  double error = 0;           // of each value, in its unit; 0 means that `relative_error` counts
  double relative_error = 0;  // share of the range of the values
  unsigned threads = 1;
  std::string title;
};

enum class StreamKind : std::uint8_t { volume, surface, particles };
[[nodiscard]] const char* name_of(StreamKind kind);

/// Encoded data of a step.
struct StepStream {
  StreamKind kind = StreamKind::volume;
  std::string field, unit;
  std::vector<std::byte> bytes;
  double max_error = 0;                          // of the values of a volume, in their unit; the stream states it
  std::uint32_t thinning = 1;                    // of a grid or of particles
  std::shared_ptr<ServedGrid> served = nullptr;  // served instead of `bytes`; null for streams
};

/// Encodes all data of a step. Adds one message to `problems` for each field that cannot be encoded. Any
/// thread.
[[nodiscard]] std::vector<StepStream> encode_step(const StepData& data, const StreamLimits& limits,
                                                  std::vector<std::string>& problems);

}  // namespace gs::app::insitu
