#pragma once

#include "app/insitu/arrays/field_view.h"
#include "app/insitu/arrays/ranks.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gs::app::insitu {

inline constexpr std::size_t kMaxFields = 16;

/// Field of a step, as ranks describe it to rank 0.
struct FieldFacts {
  std::array<char, kMaxNameBytes + 1> name{}, unit{};
  std::int32_t type = 0, of_cells = 0;
  std::uint32_t components = 1;
};

/// Data of one kind that a rank passed: blocks, cells or particles.
struct PartFacts {
  std::uint32_t parts = 0, fields = 0;  // `fields` of the first part
  std::array<FieldFacts, kMaxFields> field{};
  std::uint64_t count = 0;              // points of blocks, triangles or particles
  std::array<double, 3> low{}, high{};  // bounds of cells or particles
  double radius = 0;                    // of particles
};

/// Whole regular grid, which blocks divide.
struct GridFacts {
  std::array<std::int64_t, 6> whole{};
  std::array<double, 3> origin{}, spacing{1, 1, 1};
  friend bool operator==(const GridFacts&, const GridFacts&) = default;
};

/// Particle that rank 0 collects. The position is relative to StepPlan::origin.
struct ParticlePoint {
  std::array<float, 3> position{};
  float value = 0;  // NaN without a field
};

/// Description of the data that a rank passed in a step.
struct RankFacts {
  PartFacts blocks, cells, particles;
  GridFacts grid;
  double own_seconds = 0;  // time in the library so far
};

/// Plan of a step, broadcast by rank 0: the data that all ranks send to it.
struct StepPlan {
  std::array<char, 128> problem{};  // if not empty, the step is dropped
  GridFacts grid;
  std::uint32_t thinning = 1;  // every n-th point of the grid along each axis
  std::uint32_t grid_fields = 0, has_cells = 0, has_particles = 0;
  std::array<FieldFacts, kMaxFields> grid_field{};
  FieldFacts cell_field, particle_field;  // an empty name means no field
  // If `keeps` is 1: field that the ranks keep for requests of viewers. `grid_field` does not contain it.
  std::uint32_t keeps = 0, kept_thinning = 1;
  std::uint64_t serial = 0;  // number of the kept step
  FieldFacts kept_field;
  std::array<double, 3> origin{};  // subtracted from positions before they become float32
  double radius = 0;
  std::uint64_t max_memory = UINT64_MAX;  // for the triangles of cells, or the particles, on rank 0
  std::uint32_t particle_stride = 1;      // every n-th particle of each rank is sent
};

[[nodiscard]] FieldFacts facts_of(const FieldView& view);
/// Returns the field that the facts name, or nullptr.
[[nodiscard]] const FieldView* find_field(std::span<const FieldView> fields, const FieldFacts& facts);

/// Returns the number of points of a thinned grid along each axis, or of cells for fields of cells.
[[nodiscard]] std::array<std::uint32_t, 3> grid_size(const GridFacts& grid, bool of_cells, std::uint32_t thinning);

/// Options of rank 0 for plan_step().
struct PlanWishes {
  bool all_fields = false;                   // true for all fields of grids, false for `field` only
  std::string field;                         // empty or unknown means the first field
  std::uint64_t max_memory = 0;              // for grids
  std::uint64_t max_collected = UINT64_MAX;  // for grids that rank 0 collects, except small ones if `keep` is set
  std::uint64_t max_records = UINT64_MAX;    // bytes of the triangles of cells, or of particles
  bool keep = false;                         // lets ranks keep a large grid for requests, instead of sending it
  double kept_bytes = 2;                     // memory of a kept value
  std::uint64_t serial = 0;                  // for StepPlan::serial
};
/// Maximum number of points of a grid that rank 0 collects although PlanWishes::keep is set. Encoding such a grid takes
/// no longer than answering requests.
inline constexpr std::uint64_t kMaxCollectedPoints = std::uint64_t{1} << 16;
/// Number of steps that each rank keeps.
inline constexpr std::size_t kKeptSteps = 2;
/// Chooses the data of a step from the facts of all ranks.
[[nodiscard]] StepPlan plan_step(std::span<const RankFacts> ranks, const PlanWishes& wishes);

}  // namespace gs::app::insitu
